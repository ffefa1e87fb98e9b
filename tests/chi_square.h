// Pearson's chi-square test that samples of a 2-D domain follow a density. Header only, knows no box of the
// renderer.
//
//   TestRandom random(1);
//   const ChiSquareResult r = ChiSquareSphere<Vec3>(
//       [&]() -> std::optional<Vec3> { return SampleCosineHemisphere(random.Next2<Point2>()); },
//       [](Vec3 w) { return w.z > 0 ? CosineHemispherePdf(w.z) : 0.f; });
//   EXPECT_TRUE(r.Passes()) << r.text;
//
// After W. Jakob, the chi-square tests of Mitsuba and Nori.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace tessera {

// Uniform numbers for tests: the same sequence everywhere for one seed.
class TestRandom {
 public:
  explicit TestRandom(uint64_t seed) : engine_(seed) {}
  // In [0, 1), a multiple of 2^-24.
  float Next() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  template <typename Point2D>
  Point2D Next2() {
    const float x = Next();
    const float y = Next();
    return Point2D{x, y};
  }

 private:
  std::mt19937_64 engine_;
};

// The rectangle of samples and how finely it is cut.
struct ChiSquareGrid {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  int cells_x = 20, cells_y = 20;
  int sample_count = 200000;
};

struct ChiSquareResult {
  double p_value = 0;    // chance of so bad a fit if samples and density agree; 0 for an impossible sample
  double pdf_total = 0;  // the integral of the density over the domain
  std::string text;      // for the message of a failed test

  // Whether the fit is credible at a level of 1e-4 for all `test_count` tests together (Sidak's correction).
  bool Passes(int test_count = 1) const { return p_value > 1 - std::pow(1 - 1e-4, 1.0 / test_count); }
};

namespace chi_square {

// Q(a, x) = Gamma(a, x) / Gamma(a): the upper tail of the gamma distribution. By its series below x = a + 1,
// by its continued fraction above (modified Lentz; Press et al., Numerical Recipes, section 6.2).
inline double GammaUpperTail(double a, double x) {
  if (x <= 0) return 1;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > sum * 1e-15; ++n) sum += term *= x / (a + n);
    return std::max(0.0, 1 - scale * sum);
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-14) break;
  }
  return scale * h;
}

// Chance that chi-square with `degrees` degrees of freedom is at least `value`.
inline double PValue(double value, int degrees) {
  return GammaUpperTail(degrees * 0.5, value * 0.5);
}

struct Interval {
  double a, b, fa, fm, fb, whole, tolerance;
};

template <typename F>
double AdaptiveSimpsonStep(const F& f, const Interval& i, int depth) {
  const double m = (i.a + i.b) / 2, h = (i.b - i.a) / 12;
  const double fl = f((i.a + m) / 2), fr = f((m + i.b) / 2);
  const double left = h * (i.fa + 4 * fl + i.fm), right = h * (i.fm + 4 * fr + i.fb);
  const double error = left + right - i.whole;
  if (depth <= 0 || std::abs(error) < 15 * i.tolerance) return left + right + error / 15;
  return AdaptiveSimpsonStep(f, {i.a, m, i.fa, fl, i.fm, left, i.tolerance / 2}, depth - 1) +
         AdaptiveSimpsonStep(f, {m, i.b, i.fm, fr, i.fb, right, i.tolerance / 2}, depth - 1);
}

// The integral of f over [a, b], halving where Simpson's rule and its refinement differ. At least two
// halvings.
template <typename F>
double AdaptiveSimpson(const F& f, double a, double b, double tolerance, int depth) {
  const auto begin = [&](double from, double to) {
    const double fa = f(from), fm = f((from + to) / 2), fb = f(to);
    const double whole = (to - from) / 6 * (fa + 4 * fm + fb);
    return AdaptiveSimpsonStep(f, {from, to, fa, fm, fb, whole, tolerance / 2}, depth - 1);
  };
  return begin(a, (a + b) / 2) + begin((a + b) / 2, b);
}

struct Cell {
  double expected = 0;
  double observed = 0;
};

// Counts below are pooled: the statistic is not chi-square distributed there.
constexpr double kExpectedMin = 5;

// Pools the cells of low expected count, then sums the statistic. Returns 0 if all mass is in one pool.
inline double PooledPValue(std::vector<Cell> cells, std::string& text) {
  std::stable_sort(cells.begin(), cells.end(),
                   [](const Cell& a, const Cell& b) { return a.expected < b.expected; });
  double statistic = 0;
  int terms = 0;
  Cell pool;
  for (const Cell& cell : cells) {
    pool.expected += cell.expected;
    pool.observed += cell.observed;
    if (pool.expected < kExpectedMin) continue;
    const double difference = pool.observed - pool.expected;
    statistic += difference * difference / pool.expected;
    ++terms;
    pool = {};
  }
  text += " chi2=" + std::to_string(statistic) + " terms=" + std::to_string(terms);
  return terms < 2 ? 0 : PValue(statistic, terms - 1);
}

// The expected counts of all cells, and how much of the density lies in the domain.
template <typename Pdf>
std::vector<Cell> ExpectedCells(const Pdf& pdf, const ChiSquareGrid& grid, double& total) {
  std::vector<Cell> cells;
  const double dx = (grid.x1 - grid.x0) / grid.cells_x, dy = (grid.y1 - grid.y0) / grid.cells_y;
  const double tolerance = 1e-6 / (static_cast<double>(grid.cells_x) * grid.cells_y);
  for (int j = 0; j < grid.cells_y; ++j) {
    for (int i = 0; i < grid.cells_x; ++i) {
      const double left = grid.x0 + i * dx, low = grid.y0 + j * dy;
      const auto row = [&](double y) {
        const auto f = [&](double x) {
          return static_cast<double>(pdf(static_cast<float>(x), static_cast<float>(y)));
        };
        return AdaptiveSimpson(f, left, left + dx, tolerance / dy, 6);
      };
      const double mass = std::max(0.0, AdaptiveSimpson(row, low, low + dy, tolerance, 6));
      total += mass;
      cells.push_back({mass * grid.sample_count, 0});
    }
  }
  return cells;
}

}  // namespace chi_square

// Compares samples of a rectangle with a density. `sample()` returns an optional pair with members x and y,
// nothing for a sample that failed (the density then integrates to less than 1); `pdf(x, y)` is per unit of x
// and y.
template <typename Sample, typename Pdf>
ChiSquareResult ChiSquare(const ChiSquareGrid& grid, const Sample& sample, const Pdf& pdf) {
  using chi_square::Cell;
  ChiSquareResult result;
  std::vector<Cell> cells = chi_square::ExpectedCells(pdf, grid, result.pdf_total);
  Cell outside{std::max(0.0, 1 - result.pdf_total) * grid.sample_count, 0};
  for (int n = 0; n < grid.sample_count; ++n) {
    const auto s = sample();
    const double x = s ? (s->x - grid.x0) / (grid.x1 - grid.x0) : -1;
    const double y = s ? (s->y - grid.y0) / (grid.y1 - grid.y0) : -1;
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) {
      ++outside.observed;
      continue;
    }
    const int i = std::min(static_cast<int>(x * grid.cells_x), grid.cells_x - 1);
    const int j = std::min(static_cast<int>(y * grid.cells_y), grid.cells_y - 1);
    ++cells[static_cast<size_t>(j) * grid.cells_x + i].observed;
  }
  result.text = "pdf integrates to " + std::to_string(result.pdf_total) + ",";
  if (!(result.pdf_total < 1.01)) return result.text += " more than 1", result;
  for (const Cell& cell : cells) {
    // Rounding may put a few samples just over the edge of the support.
    if (cell.expected <= 1e-9 && cell.observed > 1 + 1e-4 * grid.sample_count) {
      result.text += " " + std::to_string(cell.observed) + " samples in a cell where the pdf is zero";
      return result;
    }
  }
  cells.push_back(outside);
  result.p_value = chi_square::PooledPValue(std::move(cells), result.text);
  result.text += " p=" + std::to_string(result.p_value);
  return result;
}

// The same for directions: `sample()` returns an optional unit vector, `pdf(w)` is per solid angle. Cells are
// equal in cos(theta) and phi, so of equal solid angle.
template <typename Direction, typename Sample, typename Pdf>
ChiSquareResult ChiSquareSphere(const Sample& sample, const Pdf& pdf, int cells_z = 20, int cells_phi = 24,
                                int sample_count = 200000) {
  struct Place {
    double x, y;
  };
  constexpr double kTwoPi = 2 * std::numbers::pi;
  const ChiSquareGrid grid{-1, 1, 0, kTwoPi, cells_z, cells_phi, sample_count};
  const auto place = [&]() -> std::optional<Place> {
    const auto w = sample();
    if (!w) return std::nullopt;
    const double phi = std::atan2(static_cast<double>(w->y), static_cast<double>(w->x));
    return Place{std::clamp(static_cast<double>(w->z), -1.0, 1.0), phi < 0 ? phi + kTwoPi : phi};
  };
  const auto density = [&](float z, float phi) {
    const float r = std::sqrt(std::max(0.f, 1 - z * z));
    return pdf(Direction{r * std::cos(phi), r * std::sin(phi), z});
  };
  return ChiSquare(grid, place, density);
}

}  // namespace tessera
