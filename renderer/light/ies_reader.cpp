// Reads IES LM-63 files: lines of text up to "TILT=", then numbers, wherever lines end.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "renderer/description/number.h"
#include "renderer/description/source_location.h"
#include "renderer/light/ies_profile.h"

namespace tessera {

namespace {

// Far more than any luminaire has: a value every tenth of a degree.
constexpr int kAnglesMax = 3601;
// Candela: brighter than the sun's disk seen as a point. Sums of all values stay finite.
constexpr float kIntensityMax = 1e25f;

}  // namespace

// Goes through the text once. The first error is kept; numbers read after it are 0.
class IesReader {
 public:
  explicit IesReader(std::string_view text) : text_(text) {}

  Result<IesProfile> Read();

 private:
  std::string_view NextLine();
  float Number(std::string_view what);
  int Count(std::string_view what, int max);
  std::vector<float> Angles(int count, std::string_view what);
  void SkipLabels();
  void SkipTilt(std::string_view tilt);
  // What the intensities of the file are multiplied by.
  float ReadLamp(int* vertical_count, int* horizontal_count);
  void SetSymmetry();
  void ReadCandela(float factor);
  void Fail(const std::string& message) {
    if (error_.empty()) error_ = fmt::format("line {}: {}", line_, message);
  }

  std::string_view text_;
  size_t at_ = 0;
  int line_ = 1;
  IesProfile profile_;
  std::string error_;
};

std::string_view IesReader::NextLine() {
  const size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  ++line_;
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
    line.remove_suffix(1);
  return line;
}

float IesReader::Number(std::string_view what) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  while (at_ < text_.size() && kSeparators.find(text_[at_]) != std::string_view::npos)
    line_ += text_[at_++] == '\n';
  const size_t end = std::min(text_.find_first_of(kSeparators, at_), text_.size());
  const std::string_view token = text_.substr(at_, end - at_);
  at_ = end;
  if (!error_.empty()) return 0;
  if (token.empty()) {
    Fail(fmt::format("the file ends where {} is expected", what));
    return 0;
  }
  const std::optional<float> number = ParseFloat(token);
  if (!number) Fail(fmt::format("expected {}, found {}", what, Quoted(token.substr(0, 40))));
  return number.value_or(0);
}

int IesReader::Count(std::string_view what, int max) {
  const float number = Number(what);
  if (!error_.empty()) return 0;
  if (number >= 1 && number <= static_cast<float>(max) && number == std::floor(number))
    return static_cast<int>(number);
  Fail(fmt::format("{} must be a whole number from 1 to {}", what, max));
  return 0;
}

std::vector<float> IesReader::Angles(int count, std::string_view what) {
  std::vector<float> angles;
  for (int i = 0; i < count && error_.empty(); ++i) {
    angles.push_back(Number(what));
    if (i > 0 && error_.empty() && !(angles[i] > angles[i - 1])) Fail(fmt::format("{}s must rise", what));
  }
  return angles;
}

void IesReader::SkipLabels() {
  constexpr std::string_view kTilt = "TILT=";
  while (at_ < text_.size()) {
    const std::string_view line = NextLine();
    if (line.starts_with(kTilt)) {
      SkipTilt(line.substr(kTilt.size()));
      return;
    }
    // Editions since 1991 name themselves and have keywords in brackets; that of 1986 has any text.
    const bool is_text = std::ranges::all_of(line, [](unsigned char c) { return c >= 0x20 || c == '\t'; });
    if (!is_text) {
      --line_;
      Fail("not a photometry file of IES LM-63: it has control characters");
      return;
    }
  }
  Fail("the file has no line \"TILT=\"; expected a photometry file of IES LM-63");
}

// Tilt factors are for lamps that are not in the position in which they were measured; this one is.
void IesReader::SkipTilt(std::string_view tilt) {
  if (tilt == "NONE") return;
  if (tilt != "INCLUDE") {
    --line_;
    Fail(fmt::format(
        "expected \"TILT=NONE\" or \"TILT=INCLUDE\"; tilt factors in another file ({}) are not read",
        Quoted(tilt.substr(0, 40))));
    return;
  }
  Number("the geometry of the tilt");
  const int count = Count("the number of tilt angles", kAnglesMax);
  for (int i = 0; i < 2 * count && error_.empty(); ++i) Number(i < count ? "a tilt angle" : "a tilt factor");
}

float IesReader::ReadLamp(int* vertical_count, int* horizontal_count) {
  Number("the number of lamps");
  Number("the lumens per lamp");
  const float multiplier = Number("the multiplier of candela values");
  *vertical_count = Count("the number of vertical angles", kAnglesMax);
  *horizontal_count = Count("the number of horizontal angles", kAnglesMax);
  const float type = Number("the photometric type");
  if (error_.empty() && type != 1) {
    const std::string_view name = type == 2 ? "type B" : type == 3 ? "type A" : "of an unknown type";
    Fail(fmt::format("the photometry is {}; only type C (1) is read", name));
  }
  for (const std::string_view what : {"the type of units", "the width", "the length", "the height"})
    Number(what);
  const float ballast = Number("the ballast factor"), lamp = Number("the ballast-lamp factor");
  Number("the input watts");
  // The second factor is "for future use" since the edition of 1995, and is 1 then.
  const float factor = multiplier * ballast * lamp;
  if (error_.empty() && !(factor > 0 && factor <= kIntensityMax))
    Fail("the multiplier of candela values and the ballast factors must be positive");
  return factor;
}

void IesReader::SetSymmetry() {
  using Symmetry = IesProfile::Symmetry;
  const std::vector<float>& vertical = profile_.vertical_;
  if (!(vertical.front() >= 0 && vertical.back() <= 180) || vertical.size() < 2) {
    Fail("vertical angles of type C must be two or more from 0 to 180 degrees");
    return;
  }
  std::vector<float>& horizontal = profile_.horizontal_;
  const float first = horizontal.front(), last = horizontal.back();
  if (horizontal.size() == 1) return;  // axial
  if (first == 90 && last == 270) {
    profile_.symmetry_ = Symmetry::kFrontBack;
  } else if (first == 0 && last == 90) {
    profile_.symmetry_ = Symmetry::kQuadrants;
  } else if (first == 0 && last == 180) {
    profile_.symmetry_ = Symmetry::kSides;
  } else if (first == 0 && last > 180 && last <= 360) {
    profile_.symmetry_ = Symmetry::kNone;
  } else {
    Fail(fmt::format(
        "horizontal angles of type C are one angle, or from 0 to 90, 180 or 360 degrees, or from 90 "
        "to 270; found {} to {}",
        first, last));
  }
}

void IesReader::ReadCandela(float factor) {
  const size_t count = profile_.vertical_.size() * profile_.horizontal_.size();
  // Each takes a digit and a separator: what is announced is compared with what is there before it is stored.
  if (error_.empty() && count > (text_.size() - at_ + 1) / 2)
    Fail("the file is shorter than the number of its angles announces");
  for (size_t i = 0; i < count && error_.empty(); ++i) {
    const float candela = Number("a candela value") * factor;
    if (!(candela >= 0 && candela <= kIntensityMax))
      Fail("candela values must not be negative, or be too large");
    profile_.candela_.push_back(candela);
  }
}

Result<IesProfile> IesReader::Read() {
  SkipLabels();
  int vertical_count = 0, horizontal_count = 0;
  const float factor = ReadLamp(&vertical_count, &horizontal_count);
  profile_.vertical_ = Angles(vertical_count, "vertical angle");
  profile_.horizontal_ = Angles(horizontal_count, "horizontal angle");
  if (error_.empty()) SetSymmetry();
  ReadCandela(factor);
  if (!error_.empty()) return BadInput(error_);
  if (profile_.symmetry_ == IesProfile::Symmetry::kNone && profile_.horizontal_.back() < 360) {
    // Closes the circle: the first values again at 360 degrees.
    profile_.horizontal_.push_back(360);
    for (size_t i = 0; i < profile_.vertical_.size(); ++i) profile_.candela_.push_back(profile_.At(0, i));
  }
  return std::move(profile_);
}

Result<IesProfile> IesProfile::Read(std::string_view text) {
  return IesReader(text).Read();
}

}  // namespace tessera
