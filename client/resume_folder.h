// `render --resume`: what is rendered of a picture is kept until the picture is finished.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "client/scene_job.h"
#include "renderer/util/result.h"

namespace tessera {

// The data directory of a local farm that outlives it, in the cache of this user. It is named after the
// files and settings that make the picture, so that nothing is ever continued with others. Used by one
// process at a time.
class ResumeFolder {
 public:
  using ReadVariable = std::function<std::string(const char* variable)>;
  // Fails if another process renders the same.
  static Result<std::unique_ptr<ResumeFolder>> Open(const PackedScene& scene,
                                                    const ReadVariable& environment);
  // Removes the folder after Finish, otherwise keeps it.
  ~ResumeFolder();
  ResumeFolder(const ResumeFolder&) = delete;
  ResumeFolder& operator=(const ResumeFolder&) = delete;

  const std::string& path() const { return path_; }
  // Whether an earlier process has left something.
  bool has_data() const { return has_data_; }
  // The same for every render of the same: a coordinator knows its job by it.
  uint64_t submission() const { return submission_; }
  // Nothing is left to continue.
  void Finish() { is_finished_ = true; }

 private:
  ResumeFolder(std::string path, int lock, bool has_data, uint64_t submission)
      : path_(std::move(path)), lock_(lock), has_data_(has_data), submission_(submission) {}

  const std::string path_;
  const int lock_;  // a descriptor
  const bool has_data_;
  const uint64_t submission_;
  bool is_finished_ = false;
};

}  // namespace tessera
