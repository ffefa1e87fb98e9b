// A table of text whose columns are as wide as their longest cell.
#pragma once

#include <string>
#include <vector>

namespace tessera {

enum class Align { kLeft, kRight };

// Names in tables have at most this many characters: one of 256 makes all lines wrap.
constexpr size_t kNameWidthMax = 40;
// The text, or its first characters and an ellipsis if it has more than `width_max`.
std::string Shortened(const std::string& text, size_t width_max = kNameWidthMax);

class TextTable {
 public:
  struct Column {
    std::string heading;
    Align align;
  };
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  // `cells` has one for each column. The remark follows them and may have any length.
  void Add(std::vector<std::string> cells, std::string remark);
  // The headings and all rows, a line each.
  std::string Text() const;

 private:
  struct Row {
    std::vector<std::string> cells;
    std::string remark;
  };
  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

}  // namespace tessera
