// A table of text whose columns are as wide as their longest cell.
#pragma once

#include <string>
#include <vector>

namespace tessera {

enum class Align { kLeft, kRight };

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
