#include "renderer/texture/texture_assembly.h"

#include "renderer/util/dispatch.h"

namespace tessera {
namespace {

template <typename T>
int Append(std::vector<T>& list, T value) {
  list.push_back(std::move(value));
  return static_cast<int>(list.size()) - 1;
}

SpectrumInput SpectrumAt(int texture) {
  SpectrumInput input;
  input.texture = texture;
  return input;
}

// Appends the operands of a node to `list` and tells the node where they are.
template <typename Node, typename Input>
void SetOperands(Node& node, std::span<const Input> operands, std::vector<Input>& list) {
  const int first = static_cast<int>(list.size());
  Dispatch(node, [&](auto& kind) {
    if constexpr (requires { kind.operand; }) kind.operand = first;
  });
  list.insert(list.end(), operands.begin(), operands.end());
}

}  // namespace

int TextureAssembly::AddMapping(const TextureMapping& mapping) {
  return Append(nodes_.mappings, mapping);
}

void TextureAssembly::Include(Size& size, Size part) {
  size.depth = std::max(size.depth, part.depth + 1);
  size.cost += part.cost;  // at most five parts of at most kTextureCostMax each
}

TextureAssembly::Size TextureAssembly::SizeOf(const FloatInput& input) const {
  return input.IsConstant() ? Size{} : float_sizes_[input.texture];
}
TextureAssembly::Size TextureAssembly::SizeOf(const SpectrumInput& input) const {
  return input.IsConstant() ? Size{} : spectrum_sizes_[input.texture];
}

const ImageTexture* TextureAssembly::FindImage(const FloatInput& input) const {
  return input.IsConstant() ? nullptr : std::get_if<ImageTexture>(&nodes_.floats[input.texture]);
}
const ImageTexture* TextureAssembly::FindImage(const SpectrumInput& input) const {
  return input.IsConstant() ? nullptr : std::get_if<ImageTexture>(&nodes_.spectra[input.texture]);
}

std::optional<FloatInput> TextureAssembly::AddFloat(FloatTextureNode node,
                                                    std::span<const FloatInput> operands,
                                                    const FloatInput& amount) {
  Size size{1, 1};
  Include(size, SizeOf(amount));
  for (const FloatInput& operand : operands) Include(size, SizeOf(operand));
  if (!IsAllowed(size)) return std::nullopt;
  SetOperands(node, operands, nodes_.float_operands);
  float_sizes_.push_back(size);
  return FloatInput{0, Append(nodes_.floats, node)};
}

std::optional<SpectrumInput> TextureAssembly::AddSpectrum(SpectrumTextureNode node,
                                                          std::span<const SpectrumInput> operands,
                                                          const FloatInput& amount) {
  Size size{1, 1};
  Include(size, SizeOf(amount));
  for (const SpectrumInput& operand : operands) Include(size, SizeOf(operand));
  if (!IsAllowed(size)) return std::nullopt;
  SetOperands(node, operands, nodes_.spectrum_operands);
  spectrum_sizes_.push_back(size);
  return SpectrumAt(Append(nodes_.spectra, node));
}

std::optional<FloatInput> TextureAssembly::Scaled(const FloatInput& input, float factor) {
  if (input.IsConstant()) return FloatInput{input.constant * factor, -1};
  if (factor == 1) return input;
  if (const ImageTexture* image = FindImage(input)) {
    ImageTexture scaled = *image;
    scaled.scale *= factor;
    return AddFloat(scaled);
  }
  return AddFloat(ScaleTexture{{factor, -1}}, {{input}});
}

std::optional<SpectrumInput> TextureAssembly::Scaled(const SpectrumInput& input, float factor) {
  if (factor == 1) return input;
  if (input.IsConstant()) return SpectrumInput{input.constant.Scaled(factor), -1};
  if (const ImageTexture* image = FindImage(input)) {
    ImageTexture scaled = *image;
    scaled.scale *= factor;
    return AddSpectrum(scaled);
  }
  return AddSpectrum(ScaleTexture{{factor, -1}}, {{input}});
}

std::optional<FloatInput> TextureAssembly::Scaled(const FloatInput& input, const FloatInput& factor) {
  if (factor.IsConstant()) return Scaled(input, factor.constant);
  if (input.IsConstant()) return Scaled(factor, input.constant);
  return AddFloat(ScaleTexture{factor}, {{input}}, factor);
}

std::optional<SpectrumInput> TextureAssembly::Scaled(const SpectrumInput& input, const FloatInput& factor) {
  if (factor.IsConstant()) return Scaled(input, factor.constant);
  return AddSpectrum(ScaleTexture{factor}, {{input}}, factor);
}

}  // namespace tessera
