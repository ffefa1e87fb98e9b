#include "renderer/texture/texture_assembly.h"

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

}  // namespace

int TextureAssembly::AddMapping(TextureMapping mapping) {
  return Append(nodes_.mappings, mapping);
}
int TextureAssembly::AddNoise(NoiseSettings settings) {
  return Append(nodes_.noises, settings);
}
int TextureAssembly::AddDirection(Vec3 direction) {
  return Append(nodes_.directions, direction);
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

bool TextureAssembly::IsImage(const FloatInput& input) const {
  return !input.IsConstant() && nodes_.floats[input.texture].kind == TextureKind::kImage;
}
bool TextureAssembly::IsImage(const SpectrumInput& input) const {
  return !input.IsConstant() && nodes_.spectra[input.texture].kind == TextureKind::kImage;
}

std::optional<FloatInput> TextureAssembly::AddFloat(TextureNode node, std::span<const FloatInput> operands) {
  Size size{1, 1};
  Include(size, SizeOf(node.amount));
  for (const FloatInput& operand : operands) Include(size, SizeOf(operand));
  if (!IsAllowed(size)) return std::nullopt;
  node.operand = static_cast<int>(nodes_.float_operands.size());
  nodes_.float_operands.insert(nodes_.float_operands.end(), operands.begin(), operands.end());
  float_sizes_.push_back(size);
  return FloatInput{0, Append(nodes_.floats, node)};
}

std::optional<SpectrumInput> TextureAssembly::AddSpectrum(TextureNode node,
                                                          std::span<const SpectrumInput> operands) {
  Size size{1, 1};
  Include(size, SizeOf(node.amount));
  for (const SpectrumInput& operand : operands) Include(size, SizeOf(operand));
  if (!IsAllowed(size)) return std::nullopt;
  node.operand = static_cast<int>(nodes_.spectrum_operands.size());
  nodes_.spectrum_operands.insert(nodes_.spectrum_operands.end(), operands.begin(), operands.end());
  spectrum_sizes_.push_back(size);
  return SpectrumAt(Append(nodes_.spectra, node));
}

FloatInput TextureAssembly::AddFloatImage(const ImageTexture& image, int mapping) {
  TextureNode node;
  node.kind = TextureKind::kImage;
  node.mapping = mapping;
  node.detail = Append(nodes_.images, image);
  float_sizes_.push_back({1, 1});
  return {0, Append(nodes_.floats, node)};
}

SpectrumInput TextureAssembly::AddSpectrumImage(const ImageTexture& image, int mapping) {
  TextureNode node;
  node.kind = TextureKind::kImage;
  node.mapping = mapping;
  node.detail = Append(nodes_.images, image);
  spectrum_sizes_.push_back({1, 1});
  return SpectrumAt(Append(nodes_.spectra, node));
}

std::optional<FloatInput> TextureAssembly::Scaled(const FloatInput& input, float factor) {
  if (input.IsConstant()) return FloatInput{input.constant * factor, -1};
  if (factor == 1) return input;
  if (IsImage(input)) {
    const TextureNode node = nodes_.floats[input.texture];
    ImageTexture image = nodes_.images[node.detail];
    image.scale *= factor;
    return AddFloatImage(image, node.mapping);
  }
  TextureNode node;
  node.kind = TextureKind::kScale;
  node.amount.constant = factor;
  return AddFloat(node, {{input}});
}

std::optional<SpectrumInput> TextureAssembly::Scaled(const SpectrumInput& input, float factor) {
  if (factor == 1) return input;
  if (input.IsConstant()) return SpectrumInput{input.constant.Scaled(factor), -1};
  if (IsImage(input)) {
    const TextureNode node = nodes_.spectra[input.texture];
    ImageTexture image = nodes_.images[node.detail];
    image.scale *= factor;
    return AddSpectrumImage(image, node.mapping);
  }
  TextureNode node;
  node.kind = TextureKind::kScale;
  node.amount.constant = factor;
  return AddSpectrum(node, {{input}});
}

std::optional<FloatInput> TextureAssembly::Scaled(const FloatInput& input, const FloatInput& factor) {
  if (factor.IsConstant()) return Scaled(input, factor.constant);
  if (input.IsConstant()) return Scaled(factor, input.constant);
  TextureNode node;
  node.kind = TextureKind::kScale;
  node.amount = factor;
  return AddFloat(node, {{input}});
}

std::optional<SpectrumInput> TextureAssembly::Scaled(const SpectrumInput& input, const FloatInput& factor) {
  if (factor.IsConstant()) return Scaled(input, factor.constant);
  TextureNode node;
  node.kind = TextureKind::kScale;
  node.amount = factor;
  return AddSpectrum(node, {{input}});
}

}  // namespace tessera
