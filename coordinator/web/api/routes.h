// The table of everything that the web interface answers under /api/v1. coordinator/page/openapi.json
// describes it; a test compares the two.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "proto/terms.h"

namespace tessera {

enum class WebAction {
  kMe,
  kFarm,
  kHistory,
  kJobs,
  kJob,
  kJobLog,
  kPicture,
  kExr,
  kPng,
  kThumbnail,
  kWorkers,
  kEvents,
  kOpenApi,
  kChangeJob,
  kChangeWorkers,
  kMissingBlobs,
  kOrderJob,
  kUploadBlob
};

// What follows the head of a request, besides requests that read.
enum class WebBody {
  kNumbers,  // a JSON object of whole numbers
  kJson,     // any JSON object, of at most kBodyPieceBytes
  kBytes     // of any kind and number; the query has the parameters
};

struct WebRoute {
  std::string_view method;
  // {job} stands for a number, {worker} for 16 hexadecimal digits and {blob} for 64.
  std::string_view path;
  // The call of the protocol whose rule decides who may ask for it (coordinator/access.h).
  std::string_view call;
  WebAction action;
  std::string_view parameters = "";  // of the query, or members of the body, separated by spaces
  WebBody body = WebBody::kNumbers;
};

inline constexpr WebRoute kWebRoutes[] = {
    {"GET", "/api/v1/me", "Jobs.List", WebAction::kMe},
    {"GET", "/api/v1/openapi.json", "Jobs.List", WebAction::kOpenApi},
    {"GET", "/api/v1/farm", "Jobs.Workers", WebAction::kFarm},
    {"GET", "/api/v1/farm/history", "Jobs.Workers", WebAction::kHistory},
    {"GET", "/api/v1/events", "Jobs.Watch", WebAction::kEvents, "job"},
    {"GET", "/api/v1/jobs", "Jobs.List", WebAction::kJobs, "search state owner sort order offset limit"},
    {"GET", "/api/v1/jobs/{job}", "Jobs.Status", WebAction::kJob, "frame"},
    {"GET", "/api/v1/jobs/{job}/log", "Jobs.JobLog", WebAction::kJobLog, "after limit"},
    {"GET", "/api/v1/jobs/{job}/picture", "Jobs.FetchPicture", WebAction::kPicture, "frame layer"},
    {"GET", "/api/v1/jobs/{job}/picture.exr", "Jobs.FetchPicture", WebAction::kExr, "frame"},
    {"GET", "/api/v1/jobs/{job}/picture.png", "Jobs.FetchPicture", WebAction::kPng, "frame"},
    {"GET", "/api/v1/jobs/{job}/thumbnail.png", "Jobs.FetchPicture", WebAction::kThumbnail, "frame size at"},
    {"POST", "/api/v1/jobs/{job}/pause", "Jobs.Pause", WebAction::kChangeJob},
    {"POST", "/api/v1/jobs/{job}/resume", "Jobs.Resume", WebAction::kChangeJob},
    {"POST", "/api/v1/jobs/{job}/cancel", "Jobs.Cancel", WebAction::kChangeJob},
    {"POST", "/api/v1/jobs/{job}/priority", "Jobs.SetPriority", WebAction::kChangeJob, "priority"},
    {"POST", "/api/v1/jobs/{job}/extend", "Jobs.Extend", WebAction::kChangeJob, "samples_per_pixel"},
    {"GET", "/api/v1/workers", "Jobs.Workers", WebAction::kWorkers,
     "search state sort order offset limit history"},
    {"POST", "/api/v1/workers/{worker}/drain", "Jobs.DrainWorkers", WebAction::kChangeWorkers},
    {"POST", "/api/v1/workers/{worker}/release", "Jobs.ReleaseWorkers", WebAction::kChangeWorkers},
    {"POST", "/api/v1/blobs/missing", "Blobs.FindMissing", WebAction::kMissingBlobs, "digests",
     WebBody::kJson},
    {"POST", "/api/v1/jobs", "Jobs.Submit", WebAction::kOrderJob,
     "submission name priority package scene_file frames frames_per_second options", WebBody::kJson},
    {"PUT", "/api/v1/blobs/{blob}", "Blobs.Upload", WebAction::kUploadBlob, "offset", WebBody::kBytes},
};

struct WebRouteMatch {
  const WebRoute* route = nullptr;
  JobId job{};
  std::string worker;  // 16 hexadecimal digits
  Digest blob{};
};

// The route of a path; nullopt if there is none. If there are only routes with other methods, `methods` names
// them.
std::optional<WebRouteMatch> FindRoute(std::string_view method, std::string_view path, std::string& methods);

// Whether a word is one of those in a list that is separated by spaces.
bool IsListed(std::string_view list, std::string_view word);

}  // namespace tessera
