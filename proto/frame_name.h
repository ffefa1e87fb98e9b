// The name of a file of which there may be one for each frame: `shot/scene.####.pbrt`, `scene.%03d.pbrt`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// A name whose places for the frame number are found once, when it is made. Every run of '#' is a place for a
// number of at least as many digits; "%d" and "%04d" are places as printf has them. Only the name of the file
// has places: the names of its folders are taken as they are written.
class FrameName {
 public:
  FrameName() = default;
  explicit FrameName(std::string name);

  // The name as it was written.
  const std::string& text() const { return text_; }
  bool empty() const { return text_.empty(); }
  bool HasPlace() const { return !places_.empty(); }
  // The name of the file of a frame.
  std::string Of(int number) const;
  // This name if it has a place, or else with ".####" before its extension: "out.exr" becomes "out.####.exr".
  FrameName WithPlace() const;

 private:
  struct Place {
    size_t begin = 0, length = 0;  // in the text
    size_t digits = 1;             // at least
  };
  std::string text_;
  std::vector<Place> places_;  // in order
};

}  // namespace tessera
