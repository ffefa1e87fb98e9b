// tessera fetch: the picture of a job.
#include <fmt/format.h>

#include "client/commands.h"
#include "client/output.h"
#include "client/watching.h"
#include "farm/coordinator_client.h"

namespace tessera {

Result<int> RunFetch(const Options& options, Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const std::string output = options.output.empty() ? fmt::format("job-{}.exr", options.job) : options.output;
  if (auto writable = CheckWritable(output); !writable) return writable.error();
  if (!options.png.empty()) {
    if (auto writable = CheckWritable(options.png); !writable) return writable.error();
  }
  const auto client = CoordinatorClient::Connect(options.coordinator, cancellation.token());
  if (!client) return client.error();
  const auto exr = (*client)->FetchPicture(JobId{options.job}, options.preview);
  if (!exr) return exr.error();
  if (auto written = WritePicture(*exr, output, options.png); !written) return written.error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}\n", options.json ? PictureJson(output, Sha256(*exr), seconds) : output);
  return 0;
}

}  // namespace tessera
