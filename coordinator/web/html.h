// Writes HTML. Text and the values of attributes are escaped here and nowhere else.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera {

class Html {
 public:
  // Names and tags are constants of this program; values may be any text.
  using Attributes = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  // Begins an element, which Close ends.
  Html& Open(std::string_view tag, Attributes attributes = {});
  Html& Close();
  // An element without content, such as meta.
  Html& Void(std::string_view tag, Attributes attributes = {});
  Html& Text(std::string_view text);
  // An element with a text.
  Html& Element(std::string_view tag, std::string_view text, Attributes attributes = {});
  // What another Html has written.
  Html& Add(std::string_view html);
  // The style sheet, a constant of this program, as it is: browsers compare its digest.
  Html& Style(std::string_view style);

  // All elements must be closed.
  std::string Take();

 private:
  void Tag(std::string_view tag, Attributes attributes);
  std::string html_;
  std::vector<std::string_view> open_;
};

// A complete document.
std::string HtmlDocument(std::string_view title, std::string_view style, std::string_view head,
                         std::string_view body);

}  // namespace tessera
