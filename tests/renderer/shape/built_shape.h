// The shapes of one directive, as the tests of their readers need them.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <map>

#include "renderer/pbrt/parser.h"
#include "renderer/shape/shape_builder.h"
#include "renderer/shape/shape_interaction.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

struct Built {
  std::vector<Shape> shapes;
  Diagnostics diagnostics;
  std::string error;
};

inline constexpr char kQuadPly[] =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 1 0 0 1 1 0 0 1 0 5 5 5 6 6 7\n4 0 1 2 3\n3 0 4 5\n";

// A square with texture coordinates.
inline constexpr char kUvPly[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";

// Builds the first shape of a world that consists of `text`.
inline Built Build(const std::string& text) {
  MemoryFiles files;
  files.files["quad.ply"] = kQuadPly;
  files.files["uv.ply"] = kUvPly;
  files.files["half.ply"] = std::string(kQuadPly, sizeof kQuadPly - 5);
  std::string packed(1000, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(kQuadPly));
  stream.avail_in = sizeof kQuadPly - 1;
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  files.files["quad.ply.gz"] = packed;

  Built built;
  const Result<SceneDescription> scene = ParseSceneText(files, "a.pbrt", "WorldBegin\n" + text + "\n");
  if (!scene) {
    built.error = scene.error().message;
    return built;
  }
  ImageCache images(files);
  Diagnostics texture_diagnostics;
  TextureBuilder textures(files, images, texture_diagnostics, Transform());
  if (const Result<void> added = textures.Add(*scene); !added) built.error = added.error().message;
  Result<std::vector<Shape>> shapes =
      BuildShape(scene->shapes[0], {}, Transform(), files, textures, built.diagnostics);
  if (shapes) {
    built.shapes = *std::move(shapes);
  } else {
    built.error = shapes.error().message;
  }
  return built;
}

template <typename Form>
const Form& Only(const Built& built) {
  static const Form kNone{};
  EXPECT_EQ(built.error, "");
  EXPECT_EQ(built.shapes.size(), 1u);
  const Form* form = built.shapes.size() == 1 ? std::get_if<Form>(&built.shapes[0].form) : nullptr;
  EXPECT_NE(form, nullptr);
  return form ? *form : kNone;
}

}  // namespace tessera
