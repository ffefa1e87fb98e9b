// Why a worker could not load a scene.
#pragma once

namespace tessera {

enum class FailureCause {
  kScene,       // the scene itself, or its files: every worker would meet the same
  kWorkerLimit  // a limit of the worker, such as its memory or its connection: another worker may load it
};

}  // namespace tessera
