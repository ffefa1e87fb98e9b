// Used-up descriptors.
#pragma once

#include <sys/resource.h>

namespace tessera {

// This process cannot open another file. Those that are open work on.
class NoNewFiles {
 public:
  NoNewFiles() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoNewFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

}  // namespace tessera
