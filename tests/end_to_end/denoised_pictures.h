// For tests of denoised pictures.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "renderer/film/picture_file.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {

class DenoisedPictures : public EndToEnd {
 protected:
  static std::vector<std::string> With(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  LoadedPicture Loaded(const std::string& name) const {
    auto picture = LoadExr(Path(name));
    EXPECT_TRUE(picture) << picture.error().message;
    return picture ? *picture : LoadedPicture();
  }
};

}  // namespace tessera
