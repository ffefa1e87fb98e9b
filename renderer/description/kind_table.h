// The kinds of one family (materials, shapes, samplers, ...) by the names that scenes and options use for
// them. One table per family decides what is read, how a misspelled or unsupported name is answered, and
// what the help, `info` and the guide list.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/source_location.h"
#include "renderer/util/text.h"

namespace tessera {

enum class Support {
  kSupported,
  kMapped,        // something else is done instead, with a warning that names it
  kNotSupported,  // known, and refused
};

// A kind as lists show it.
struct KindInfo {
  std::string_view name;
  Support support = Support::kSupported;
  std::string_view instead = {};  // of a mapped kind: what is done instead
};

// The kinds of one family.
struct KindList {
  std::string_view family;  // "material": the word for messages
  std::vector<KindInfo> kinds;
};

// A kind with what reads it: a function, or the enumerator that it stands for.
template <typename Reader>
struct Kind {
  std::string_view name;
  Support support = Support::kSupported;
  Reader reader{};
  std::string_view instead = {};
};

// A view of a constant table of kinds.
template <typename Reader>
class KindTable {
 public:
  constexpr KindTable(std::string_view family, std::span<const Kind<Reader>> kinds)
      : family_(family), kinds_(kinds) {}

  // Returns the kind of this name, or null if there is none or it is not supported.
  const Kind<Reader>* Find(std::string_view name) const {
    const Kind<Reader>* kind = FindAny(name);
    return kind != nullptr && kind->support != Support::kNotSupported ? kind : nullptr;
  }

  // Whether there is a kind of this name, supported or not.
  bool IsKnown(std::string_view name) const { return FindAny(name) != nullptr; }

  // Why Find returned null: `unknown material "difuse" (did you mean "diffuse"?)`, or that the kind is not
  // supported.
  std::string Refusal(std::string_view name) const {
    if (IsKnown(name)) return fmt::format("{} \"{}\" is not supported yet", family_, name);
    std::vector<std::string_view> names;
    for (const Kind<Reader>& kind : kinds_) names.push_back(kind.name);
    return fmt::format("unknown {} {}{}", family_, Quoted(name), DidYouMean(name, names));
  }

  // The names of the kinds of this support, in the order of the table.
  std::vector<std::string_view> Names(Support support = Support::kSupported) const {
    std::vector<std::string_view> names;
    for (const Kind<Reader>& kind : kinds_) {
      if (kind.support == support) names.push_back(kind.name);
    }
    return names;
  }

  KindList List() const {
    KindList list{family_, {}};
    for (const Kind<Reader>& kind : kinds_) list.kinds.push_back({kind.name, kind.support, kind.instead});
    return list;
  }

  std::span<const Kind<Reader>> kinds() const { return kinds_; }

 private:
  const Kind<Reader>* FindAny(std::string_view name) const {
    for (const Kind<Reader>& kind : kinds_) {
      if (kind.name == name) return &kind;
    }
    return nullptr;
  }

  std::string_view family_;
  std::span<const Kind<Reader>> kinds_;
};

}  // namespace tessera
