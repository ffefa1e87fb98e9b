#include "client/commands/text_table.h"

#include <algorithm>

#include "renderer/util/check.h"

namespace tessera {
namespace {

// Whether a character of UTF-8 begins with the byte.
bool BeginsCharacter(char c) {
  return (c & 0xc0) != 0x80;
}

// Each character counts as one column.
size_t WidthOf(const std::string& text) {
  return static_cast<size_t>(std::ranges::count_if(text, BeginsCharacter));
}

}  // namespace

std::string Shortened(const std::string& text, size_t width_max) {
  TESSERA_CHECK(width_max > 0);
  if (WidthOf(text) <= width_max) return text;
  size_t end = 0;
  for (size_t characters = 0; end < text.size(); ++end) {
    if (BeginsCharacter(text[end]) && ++characters == width_max) break;
  }
  return text.substr(0, end) + "\u2026";
}

void TextTable::Add(std::vector<std::string> cells, std::string remark) {
  TESSERA_CHECK(cells.size() == columns_.size());
  rows_.push_back({std::move(cells), std::move(remark)});
}

std::string TextTable::Text() const {
  std::vector<size_t> widths;
  std::vector<std::string> headings;
  for (const Column& column : columns_) {
    headings.push_back(column.heading);
    widths.push_back(WidthOf(column.heading));
  }
  for (const Row& row : rows_) {
    for (size_t i = 0; i < widths.size(); ++i) widths[i] = std::max(widths[i], WidthOf(row.cells[i]));
  }
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells, const std::string& remark) {
    std::string line;
    for (size_t i = 0; i < cells.size(); ++i) {
      const std::string space(widths[i] - WidthOf(cells[i]), ' ');
      line += i == 0 ? "" : "  ";
      line += columns_[i].align == Align::kLeft ? cells[i] + space : space + cells[i];
    }
    if (!remark.empty()) line += "  " + remark;
    line.resize(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add(headings, "");
  for (const Row& row : rows_) add(row.cells, row.remark);
  return text;
}

}  // namespace tessera
