#include "coordinator/web/html.h"

#include "proto/terms.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : CleanText(text, kReasonBytesMax)) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&#39;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

}  // namespace

void Html::Tag(std::string_view tag, Attributes attributes) {
  (html_ += '<') += tag;
  for (const auto& [name, value] : attributes) ((((html_ += ' ') += name) += "=\"") += Escaped(value)) += '"';
  html_ += '>';
}

Html& Html::Open(std::string_view tag, Attributes attributes) {
  Tag(tag, attributes);
  open_.push_back(tag);
  return *this;
}

Html& Html::Close() {
  TESSERA_CHECK(!open_.empty());
  ((html_ += "</") += open_.back()) += '>';
  open_.pop_back();
  return *this;
}

Html& Html::Void(std::string_view tag, Attributes attributes) {
  Tag(tag, attributes);
  return *this;
}

Html& Html::Text(std::string_view text) {
  html_ += Escaped(text);
  return *this;
}

Html& Html::Element(std::string_view tag, std::string_view text, Attributes attributes) {
  return Open(tag, attributes).Text(text).Close();
}

Html& Html::Add(std::string_view html) {
  html_ += html;
  return *this;
}

Html& Html::Style(std::string_view style) {
  ((html_ += "<style>") += style) += "</style>";
  return *this;
}

std::string Html::Take() {
  TESSERA_CHECK(open_.empty());
  return std::move(html_);
}

std::string HtmlDocument(std::string_view title, std::string_view style, std::string_view head,
                         std::string_view body) {
  Html html;
  html.Add("<!doctype html>\n").Open("html", {{"lang", "en"}}).Open("head");
  html.Void("meta", {{"charset", "utf-8"}}).Element("title", title);
  html.Void("meta", {{"name", "viewport"}, {"content", "width=device-width"}});
  html.Add(head).Style(style).Close();
  html.Open("body").Add("\n").Add(body).Close().Close();
  return html.Take() + "\n";
}

}  // namespace tessera
