#include "renderer/description/diagnostics.h"

#include <fmt/format.h>

#include "renderer/util/text.h"

namespace tessera {

void Diagnostics::Warn(const SourceLocation& where, const std::string& message) {
  Warn(where.Text(), message);
}

void Diagnostics::Warn(const std::string& subject, const std::string& message) {
  Diagnostic warning{OneLine(subject), OneLine(message)};
  if (warned_.contains({warning.place, warning.message})) return;
  if (warnings_.size() == kWarningsMax) {
    ++warnings_dropped_;
    return;
  }
  warned_.emplace(warning.place, warning.message);
  warnings_.push_back(std::move(warning));
}

void Diagnostics::WarnOnce(const std::string& topic, const SourceLocation& where,
                           const std::string& message) {
  if (topics_warned_.insert(topic).second) Warn(where, message);
}

bool Diagnostics::Fail(const SourceLocation& where, const std::string& message) {
  return Fail(ErrorAt(where, message));
}

bool Diagnostics::Fail(Error error) {
  if (!error_) error_ = std::move(error);
  return false;
}

std::vector<std::string> Diagnostics::WarningTexts() const {
  std::vector<std::string> texts;
  texts.reserve(warnings_.size() + 1);
  for (const Diagnostic& warning : warnings_) texts.push_back(warning.Text());
  if (warnings_dropped_ > 0) texts.push_back(fmt::format("{} further warnings", warnings_dropped_));
  return texts;
}

}  // namespace tessera
