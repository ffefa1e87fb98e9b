// What the readers of a scene report beside the scene itself: errors, and warnings about what the picture
// will not show as the scene asks for it. A plain value; each message has its place.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "renderer/description/source_location.h"

namespace tessera {

// More warnings than a person reads. Further ones are counted.
constexpr size_t kWarningsMax = 100;

struct Diagnostic {
  std::string place;    // "file:line:column", or the name of a file or option as a whole
  std::string message;  // one line of valid UTF-8

  std::string Text() const { return place + ": " + message; }
};

class Diagnostics {
 public:
  // Adds a warning unless the same one was added before: the same message at the same place.
  void Warn(const SourceLocation& where, const std::string& message);
  // The same for something that has no line of its own, such as a whole file.
  void Warn(const std::string& subject, const std::string& message);
  // Adds a warning unless one of the same topic was added before, wherever.
  void WarnOnce(const std::string& topic, const SourceLocation& where, const std::string& message);

  // Keeps the first error only. Always returns false, for use as the return value of a failed step.
  bool Fail(const SourceLocation& where, const std::string& message);
  bool Fail(Error error);  // already names its place
  const std::optional<Error>& error() const { return error_; }

  const std::vector<Diagnostic>& warnings() const { return warnings_; }
  // "place: message" of each warning, in the order in which they were added; the last line counts those
  // beyond kWarningsMax.
  std::vector<std::string> WarningTexts() const;

 private:
  std::optional<Error> error_;
  std::vector<Diagnostic> warnings_;
  std::set<std::pair<std::string, std::string>> warned_;  // place and message of all warnings that are kept
  std::set<std::string> topics_warned_;
  size_t warnings_dropped_ = 0;
};

}  // namespace tessera
