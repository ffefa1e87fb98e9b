#include "renderer/denoise/oidn_denoiser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "renderer/util/text.h"

namespace tessera {
namespace {

using Image = std::vector<float>;  // three values for each pixel

// What its network was trained for, and more than any display shows.
constexpr float kBrightest = 65504.0f;

// Releases whose interface is known: 10000 times the first number, 100 times the second.
constexpr int kVersionMin = 10400, kVersionMax = 29999;

std::string VersionText(int version) {
  return fmt::format("{}.{}.{}", version / 10000, version / 100 % 100, version % 100);
}

Image ImageOf(const LoadedPicture& picture, const std::array<size_t, kColors>& channels, float min,
              float max) {
  Image image;
  image.reserve(static_cast<size_t>(picture.bounds.area()) * kColors);
  for (size_t i = 0; i < picture.values.size(); i += picture.channels.size()) {
    for (const size_t c : channels) {
      const float value = picture.values[i + c];
      image.push_back(std::isnan(value) ? 0 : std::clamp(value, min, max));
    }
  }
  return image;
}

// One run of the library. Its objects are released with it.
class Run {
 public:
  Run(const oidn::Functions& functions, std::string name) : oidn_(functions), name_(std::move(name)) {}

  Result<void> Open(int threads) {
    device_.reset(oidn_.new_device(oidn::kProcessor));
    if (device_ == nullptr) return LastError("cannot be started");
    oidn_.set_device_int(device_.get(), "numThreads", threads);
    oidn_.set_device_bool(device_.get(), "setAffinity", false);  // other programs use the cores as well
    oidn_.commit_device(device_.get());
    if (auto ok = Check("cannot be started"); !ok) return ok;
    version_ = oidn_.get_device_int(device_.get(), "version");
    if (version_ >= kVersionMin && version_ <= kVersionMax) return {};
    return Failed(
        fmt::format("{}: the Open Image Denoise that is installed has version {}, expected 1.4 to 2", name_,
                    VersionText(version_)));
  }
  Result<void> Filter(Image& color, Image& albedo, Image& normal, Image& output, const PixelBounds& bounds,
                      const std::stop_token& stop) {
    filter_.reset(oidn_.new_filter(device_.get(), "RT"));
    if (filter_ == nullptr) return LastError("has no filter for rendered pictures");
    const auto set = [&](const char* image, Image& values) {
      oidn_.set_image(filter_.get(), image, values.data(), oidn::kFloat3, static_cast<size_t>(bounds.width()),
                      static_cast<size_t>(bounds.height()), 0, 0, 0);
    };
    set("color", color);
    set("albedo", albedo);
    set("normal", normal);
    set("output", output);
    oidn_.set_filter_bool(filter_.get(), "hdr", true);
    const auto goes_on = [](void* user, double) {
      return !static_cast<const std::stop_token*>(user)->stop_requested();
    };
    oidn_.set_monitor(filter_.get(), goes_on, const_cast<std::stop_token*>(&stop));
    oidn_.commit_filter(filter_.get());
    if (auto ok = Check("refuses the picture"); !ok) return ok;
    oidn_.execute_filter(filter_.get());
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    return Check("failed");
  }
  int version() const { return version_; }

 private:
  Error ErrorOf(const char* what, int code, const char* text) const {
    const bool has_text = text != nullptr && *text != '\0';
    return Failed(fmt::format("{}: Open Image Denoise {}: {}", name_, what,
                              has_text ? OneLine(text) : fmt::format("error {}", code)));
  }
  // The error of a call that returned null.
  Error LastError(const char* what) {
    const char* text = nullptr;
    const int code = oidn_.get_device_error(device_.get(), &text);
    return ErrorOf(what, code, text);
  }
  Result<void> Check(const char* what) {
    const char* text = nullptr;
    const int code = oidn_.get_device_error(device_.get(), &text);
    return code == oidn::kNoError ? Result<void>() : ErrorOf(what, code, text);
  }

  const oidn::Functions& oidn_;
  const std::string name_;
  int version_ = 0;
  std::unique_ptr<oidn::Device, void (*)(oidn::Device*)> device_{nullptr, oidn_.release_device};
  std::unique_ptr<oidn::Filter, void (*)(oidn::Filter*)> filter_{nullptr, oidn_.release_filter};
};

}  // namespace

Result<DenoisedColors> DenoiseWithOidn(const LoadedPicture& picture, const InputLayers& layers,
                                       const std::string& name, int threads, const std::stop_token& stop) {
  const auto library = oidn::Load();
  if (!library) return Failed(fmt::format("{}: {}", name, library.error().message));
  return DenoiseWithOidn(**library, picture, layers, name, threads, stop);
}

Result<DenoisedColors> DenoiseWithOidn(const oidn::Library& library, const LoadedPicture& picture,
                                       const InputLayers& layers, const std::string& name, int threads,
                                       const std::stop_token& stop) {
  Image albedo = ImageOf(picture, layers.albedo, 0, 1);
  Image normal = ImageOf(picture, layers.normal, -1, 1);
  Run run(library.functions, name);
  if (auto opened = run.Open(threads); !opened) return opened.error();
  const size_t signals = (1 + layers.groups.size()) * kColors;
  std::vector<float> denoised(albedo.size() / kColors * signals);
  for (size_t first = 0; first < signals; first += kColors) {
    const auto& channels = first == 0 ? layers.color : layers.groups[first / kColors - 1].color;
    Image color = ImageOf(picture, channels, 0, kBrightest), output(color.size());
    if (auto ok = run.Filter(color, albedo, normal, output, picture.bounds, stop); !ok) return ok.error();
    for (size_t i = 0; i < output.size(); ++i)
      denoised[i / kColors * signals + first + i % kColors] = std::isfinite(output[i]) ? output[i] : color[i];
  }
  for (size_t i = 0; i < denoised.size() / signals; ++i)
    SettleColors(&picture.values[i * picture.channels.size()], layers, &denoised[i * signals]);
  return DenoisedColors{std::move(denoised), "oidn " + VersionText(run.version())};
}

}  // namespace tessera
