// Removes the noise of rendered pictures, guided by the layers albedo, normal and depth.
//
// The method is nonlinearly weighted first-order regression: Bitterli, Rousselle, Moon, Iglesias-Guitian,
// Adler, Mitchell, Jarosz and Novak, "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo
// Renderings", EGSR 2016. Around each pixel the colours are fitted by a linear function of the features
// (albedo, normal, depth), with the weights of non-local means for rendered pictures: Rousselle, Knaus and
// Zwicker, "Adaptive Rendering with Non-Local Means Filtering", SIGGRAPH Asia 2012. The fits of all pixels
// around contribute to a pixel.
//
//   - The layer "halves" splits the picture into two independent ones. In a first pass, each is denoised with
//     the weights of the other, so that weights and noise are not correlated. The difference of the halves
//     estimates the variance that the weights need.
//   - In a second pass, the picture is denoised with the weights of what the first one made of it, as the
//     second step of BM3D uses the estimate of its first one: Dabov, Foi, Katkovnik and Egiazarian, "Image
//     Denoising by Sparse 3-D Transform-Domain Collaborative Filtering", IEEE Transactions on Image
//     Processing 16(8), 2007. This keeps edges that are hidden in the noise of the halves: samples are well
//     distributed over a pixel, so their mean has far less noise than either half.
//   - Colours are divided by the albedo before and multiplied by it after, which keeps textures.
//   - Albedo and normal of what glass shows have noise of their own, as paths are chosen at random between
//     reflection and transmission. They matter less where they do (local_regression.h).
//   - The light of each group of lights is fitted with the weights of the colours. What the fits of the
//     groups of a pixel lack to its colour, or exceed it, is shared among them in proportion, so that their
//     sum is the denoised picture and tessera relight can mix them.
//   - Single pixels that are far brighter than all around (fireflies) are darkened before, since no filter
//     of this size can spread their light far enough. Their light is returned to the pixels in a wider radius
//     afterwards (lost_light.h), so that the picture keeps its mean.
//
// With Denoiser::kOidn, Open Image Denoise does this instead, if it is installed (oidn_library.h). Its neural
// network needs the layers albedo and normal, and all of the picture in memory once more. Values then depend
// on its version and on the processor.
//
// The picture is processed in strips of rows. Beside the picture and its result, memory holds some 43 KB for
// each pixel of width, and what the first pass made: 24 bytes for each pixel. Values are the same for any
// number of threads.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// The layer of the result that keeps the colours as they were.
constexpr const char* kNoisyLayer = "noisy";
// The same for a layer that is denoised beside them: "noisy_light_key" for "light_key".
std::string NoisyLayerOf(const std::string& layer);

// Attributes of the header: what the colours were denoised with, and why they could not be.
constexpr const char* kDenoiserAttribute = "tessera:denoiser";
constexpr const char* kDenoiseFailedAttribute = "tessera:denoiseFailed";

// Whether Denoise accepts the picture. The error names it `name` and lists the layers that are missing.
Result<void> CheckDenoisable(const LoadedPicture& picture, const std::string& name,
                             Denoiser denoiser = Denoiser::kRegression);

// The layers of three channels that Denoise adds to those that the picture has.
std::vector<std::string> AddedLayers(const LoadedPicture& picture);

// The picture with R, G, B and the light of groups denoised and the layers "noisy" and "noisy_light_..."
// added; a layer of such a name that is there already is what is denoised, so that denoising twice is the
// same as once. Values that are not finite count as black if they are not a number, else as very bright.
// Fails if CheckDenoisable does, if memory runs out or a stop is requested.
Result<LoadedPicture> Denoise(const LoadedPicture& picture, const std::string& name, int threads,
                              const std::stop_token& stop, Denoiser denoiser = Denoiser::kRegression);

}  // namespace tessera
