// Channels of every rule are functions of the set of samples: any cut, order and copies give the same bits.
#include "renderer/film/merge_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "renderer/film/dyadic_sum.h"
#include "renderer/film/merger.h"
#include "tests/renderer/film/adaptive_frames.h"
#include "tests/renderer/film/rule_frames.h"

namespace tessera {
namespace {

std::vector<TileNode> Nodes(const Merger& merger) {
  return merger.AllNodes();
}

TileRequest RequestOf(const RadianceTile& tile) {
  return {tile.bounds, tile.range, tile.shape};
}

// All units as a worker sends them: through the codec.
void AddUnit(Merger& merger, int tile, SampleRange range, uint32_t objects) {
  const RadianceTile rendered = RenderRules(merger.spec(), tile, range, {}, objects);
  const auto sent = EncodeRadianceTile(rendered);
  auto received = DecodeRadianceTile(sent, RequestOf(rendered));
  ASSERT_TRUE(received) << received.error().message;
  ASSERT_EQ(EncodeRadianceTile(*received), sent);
  ASSERT_TRUE(merger.Add(tile, std::move(*received)));
}

Merger MergeWhole(const FrameSpec& spec, uint32_t objects) {
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (auto missing = merger.Missing(tile); !missing.empty(); missing = merger.Missing(tile)) {
      for (const SampleRange range : missing) AddUnit(merger, tile, range, objects);
    }
  }
  return merger;
}

// With 60 objects the sets overflow, and what is dropped must not depend on the cut.
TEST(MergeRules, AnyCutOrderAndCopiesGiveTheSameBits) {
  for (const uint32_t objects : {5u, 60u}) {
    for (const uint32_t samples : {1u, 13u, 64u, 100u, 256u}) {
      const FrameSpec spec = RuleSpec(samples);
      const Merger expected = MergeWhole(spec, objects);
      std::mt19937 generator(samples);
      for (int round = 0; round < 4; ++round) {
        Merger merger(spec);
        for (const TileUnit& unit : RandomUnits(spec, generator))
          AddUnit(merger, unit.tile, unit.range, objects);
        ASSERT_TRUE(merger.Complete());
        ASSERT_EQ(Nodes(merger), Nodes(expected)) << samples << " samples, round " << round;
        ASSERT_EQ(merger.Picture().values, expected.Picture().values);
      }
    }
  }
}

TEST(MergeRules, AdaptiveFramesKeepThemToo) {
  const FrameSpec spec = RuleSpec(256, 0.3);
  const Merger expected = MergeWhole(spec, 5);
  EXPECT_LT(expected.samples_merged(), expected.spec().crop.area() * 256u) << "some pixels stop";
  std::mt19937 generator(1);
  for (int round = 0; round < 5; ++round) {
    Merger merger(spec);
    for (const TileUnit& unit : RandomUnits(spec, generator)) AddUnit(merger, unit.tile, unit.range, 5);
    ASSERT_EQ(Nodes(merger), Nodes(expected));
  }
}

TEST(MergeRules, APictureIsThatOfAllItsSamples) {
  const FrameSpec spec = RuleSpec(16);
  const FramePicture picture = MergeWhole(spec, 5).Picture();
  EXPECT_THAT(picture.channels, testing::IsSupersetOf({"R", "albedo.R", "Z", "near.R", "object00.R",
                                                       "object02.A", "material00.R", "samples"}));
  DyadicSum<float> albedo, weight;
  std::map<uint32_t, DyadicSum<float>> objects;  // of all samples, 0 where another was hit
  RuleSample nearest{};
  for (uint32_t s = 0; s < 16; ++s) {
    const RuleSample sample = SampleOf(1, 2, s, 5);
    albedo.Add(sample.albedo * sample.weight);
    weight.Add(sample.weight);
    for (uint32_t id = 0; id < 5; ++id)
      objects[id].Add(sample.depth > 0 && sample.object == id ? sample.weight : 0.0f);
    if (sample.depth > 0 && (nearest.depth == 0 || sample.depth < nearest.depth)) nearest = sample;
  }
  EXPECT_EQ(picture.Channel("albedo.R")[0], albedo.Node() / weight.Node());
  EXPECT_EQ(picture.Channel("Z")[0], nearest.depth);
  EXPECT_EQ(picture.Channel("near.R")[0], nearest.near_red) << "of equal depths the first sample's";
  EXPECT_EQ(picture.Channel("samples")[0], 16);
  std::vector<IdWeight> ranked;
  for (auto& [id, sum] : objects) ranked.push_back({IdOf(id), sum.Node()});
  std::ranges::stable_sort(ranked, std::ranges::greater(), &IdWeight::weight);
  EXPECT_EQ(picture.Channel("object00.R")[0], ranked[0].id);
  EXPECT_EQ(picture.Channel("object00.G")[0], ranked[0].weight / weight.Node());
  EXPECT_EQ(picture.Channel("object01.B")[0], ranked[3].id);
  EXPECT_EQ(picture.Channel("object01.A")[0], ranked[3].weight / weight.Node());
}

TEST(MergeRules, WhatHitNothingIsFartherThanAnything) {
  const PixelShape shape{1, 2, 0};
  const std::vector<float> nothing{1, 0, 0}, hit{1, 1e30f, 7};
  std::vector<float> left = nothing;
  MergeSiblings(shape, 1, left, hit, left);
  EXPECT_THAT(left, testing::ElementsAre(2, 1e30f, 7));
  left = hit;
  MergeSiblings(shape, 1, left, nothing, left);
  EXPECT_THAT(left, testing::ElementsAre(2, 1e30f, 7));
}

TEST(MergeRules, ABackgroundIsInfinitelyFar) {
  FrameSpec spec = RuleSpec(1);
  Merger merger(spec);
  RadianceTile tile = RenderRules(spec, 0, {0, 1});
  tile.sums[*spec.Layout().SlotOf("Z")] = 0;
  ASSERT_TRUE(merger.Add(0, tile));
  EXPECT_EQ(merger.Picture().Channel("Z")[0], std::numeric_limits<float>::infinity());
}

TEST(MergeRules, BeyondTheBoundTheLeastWeightsAreDropped) {
  IdSet left, right, merged;
  for (uint32_t i = 1; i <= kIdsPerPixelMax; ++i) left.push_back({static_cast<float>(i), 1});
  right = {{2.0f, -1.5f}, {100.0f, 0.25f}, {101.0f, 2.0f}};
  MergeIds(left, right, merged);
  IdSet expected = left;
  expected[1].weight = -0.5f;
  // 100 has the least weight, then comes 2 with 0.5.
  expected.erase(expected.begin() + 1);
  expected.push_back({101.0f, 2.0f});
  EXPECT_EQ(merged, expected);
  right = {{100.0f, 1.0f}};
  MergeIds(left, right, merged);
  EXPECT_EQ(merged, left) << "of equal weights the larger id goes";
}

TEST(MergeRules, KeepPixelsTakesTheIdsOfTheOthersOut) {
  const FrameSpec spec = RuleSpec(4);
  const RadianceTile whole = RenderRules(spec, 0, {0, 4});
  std::vector<bool> chosen(static_cast<size_t>(whole.bounds.area()), false);
  chosen[2] = chosen[5] = true;
  RadianceTile kept = whole;
  KeepPixels(PixelMask::Of(chosen), kept);
  EXPECT_EQ(kept, RenderRules(spec, 0, {0, 4}, PixelMask::Of(chosen)));
  EXPECT_EQ(DecodeRadianceTile(EncodeRadianceTile(kept), RequestOf(kept)).value(), kept);
  EXPECT_LT(kept.sums.size(), whole.sums.size());
}

TEST(MergeRules, ValuesThatNoTileHasAreRefused) {
  const FrameSpec spec = RuleSpec(4);
  const RadianceTile good = RenderRules(spec, 0, {0, 4});
  const auto pixels = static_cast<size_t>(good.bounds.area());
  const auto check = [&](auto spoil) {
    std::vector<float> values = good.sums;
    spoil(values);
    return CheckValues(good.shape, pixels, values).has_value();
  };
  const size_t set = good.shape.stride() - 2, entries = pixels * good.shape.stride();
  EXPECT_TRUE(check([](auto&) {}));
  EXPECT_FALSE(check([](auto& v) { v.pop_back(); }));
  EXPECT_FALSE(check([](auto& v) { v.insert(v.end(), {5, 1}); }));
  EXPECT_FALSE(check([&](auto& v) { v[good.shape.sums] = -1; })) << "a depth";
  for (const float size : {-1.0f, 0.5f, 33.0f, 1e9f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_FALSE(check([&](auto& v) { v[set] = size; })) << size;
  ASSERT_GE(good.sums[set], 2) << "the first pixel has two objects";
  EXPECT_FALSE(check([&](auto& v) { v[entries] = v[entries + 2]; })) << "an id twice";
  EXPECT_FALSE(check([&](auto& v) { std::swap(v[entries], v[entries + 2]); })) << "ids out of order";
  EXPECT_FALSE(check([&](auto& v) { v[entries] = 0; })) << "no id";
}

TEST(MergeRules, SumsOfTheLargestValuesStayFiniteAndDoNotDependOnTheCut) {
  FrameSpec spec;
  spec.width = spec.height = spec.crop.x1 = spec.crop.y1 = 1;
  spec.samples_per_pixel = 8;
  const ChannelLayout layout = spec.Layout();
  const auto render = [&](SampleRange range) {
    TileBuilder tile(layout, spec.TileBounds(0), range);
    for (uint32_t s = 0; s < range.size; ++s) {
      std::fill_n(tile.Values(), layout.shape().sums, std::numeric_limits<float>::max());
      tile.AddSample();
    }
    tile.EndPixel();
    return tile.Take();
  };
  Merger whole(spec), pieces(spec);
  ASSERT_TRUE(whole.Add(0, render({0, 8})));
  for (uint32_t s = 0; s < 8; ++s) {
    const RadianceTile rendered = render({s, 1});
    auto received = DecodeRadianceTile(EncodeRadianceTile(rendered), RequestOf(rendered));
    ASSERT_TRUE(received) << received.error().message;
    ASSERT_TRUE(pieces.Add(0, std::move(*received)));
  }
  EXPECT_EQ(Nodes(pieces), Nodes(whole));
  for (const float sum : *Nodes(whole).at(0).sums) EXPECT_TRUE(std::isfinite(sum)) << sum;
  RadianceTile most = render({0, 8});
  for (uint32_t samples = 8; samples < kSamplesPerPixelMax; samples *= 2)
    MergeSiblings(most.shape, 1, most.sums, most.sums, most.sums);
  for (const float sum : most.sums) EXPECT_TRUE(std::isfinite(sum)) << sum;
}

TEST(MergeRules, ATileWhoseSumsAreLargerThanItsSamplesAllowIsRefused) {
  const RadianceTile good = RenderRules(RuleSpec(4), 0, {0, 4});
  const auto decodes = [&](size_t at, float value) {
    RadianceTile tile = good;
    tile.sums[at] = value;
    return DecodeRadianceTile(EncodeRadianceTile(tile), RequestOf(tile)).has_value();
  };
  const size_t entries = static_cast<size_t>(good.bounds.area()) * good.shape.stride();
  const float most = 4 * kSampleValueMax;
  EXPECT_TRUE(decodes(0, -most));
  EXPECT_FALSE(decodes(0, most * 1.001f));
  EXPECT_TRUE(decodes(entries + 1, most));
  EXPECT_FALSE(decodes(entries + 1, most * 1.001f)) << "the weight of an id";
  EXPECT_TRUE(decodes(good.shape.sums, std::numeric_limits<float>::max())) << "a depth is not added up";
}

TEST(MergeRules, EveryFlippedByteOfATileIsRefusedAndNoneHarms) {
  const RadianceTile tile = RenderRules(RuleSpec(2), 1, {0, 2});
  const std::string bytes = EncodeRadianceTile(tile);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
    EXPECT_FALSE(DecodeRadianceTile(damaged, RequestOf(tile))) << i;
    // With the checksum made right again: refused, or within its limits.
    const std::string_view body(damaged.data(), damaged.size() - 8);
    const Digest digest = Sha256(body);
    std::copy_n(digest.bytes.begin(), 8, damaged.end() - 8);
    const auto decoded = DecodeRadianceTile(damaged, RequestOf(tile));
    if (!decoded) continue;
    EXPECT_TRUE(
        CheckValues(decoded->shape, static_cast<size_t>(decoded->bounds.area()), decoded->sums).has_value());
  }
}

}  // namespace
}  // namespace tessera
