// What is at the path where a command will write, with all links followed.
#pragma once

#include <sys/stat.h>

#include <compare>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

// The path that stands for the standard output. A file of this name is "./-".
constexpr char kStandardOutput[] = "-";
// The path as messages show it.
std::string ShownPath(const std::string& path);

// Tells files apart: two paths have equal identities if and only if writing to one changes the other. A file
// that does not exist yet is identified by its folder and its name in it.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;   // of the file, or of its folder if it does not exist yet
  std::string name;  // empty if the file exists
  auto operator<=>(const FileIdentity&) const = default;
};

struct OutputTarget {
  enum class Kind {
    kNew,         // nothing is there yet
    kRegular,     // a file that will be replaced
    kStream,      // a pipe or a character device
    kDescriptor,  // an open file of this process, such as - or /dev/stdout
  };
  Kind kind = Kind::kNew;
  std::string path;       // behind the links
  struct stat status {};  // unless it is new
  int descriptor = -1;    // kDescriptor
  FileIdentity identity;

  std::string folder() const;
};

// Follows the links of `path` and examines what is there. Refuses folders, block devices, sockets, files that
// nobody may write to, descriptors that are terminals or not open for writing, and names in folders that do
// not exist.
Result<OutputTarget> ExamineOutput(const std::string& path);

// The identity of a file that is read. Compares with those of outputs.
Result<FileIdentity> IdentityOfInput(const std::string& path);

}  // namespace tessera
