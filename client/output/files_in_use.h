// The files that one command reads and writes.
#pragma once

#include <map>
#include <string>

#include "client/output/output_target.h"
#include "renderer/util/result.h"

namespace tessera {

// Refuses a command that would overwrite what it reads or write two things to one file, however the paths are
// spelled. Devices may be given several times.
class FilesInUse {
 public:
  void AddInput(const std::string& path);
  // Fails if nothing can be written there (ExamineOutput), or if the file is an input or another output. Add
  // the inputs first.
  Result<void> AddOutput(const std::string& path);

 private:
  struct Use {
    std::string path;  // as it was written
    bool is_input;
  };
  std::map<FileIdentity, Use> uses_;
};

}  // namespace tessera
