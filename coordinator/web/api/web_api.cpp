#include "coordinator/web/api/web_api.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "coordinator/core/guarded_result.h"
#include "coordinator/page/page_files.h"
#include "coordinator/web/api/body_routes.h"
#include "coordinator/web/api/encoded_picture.h"
#include "coordinator/web/api/file_stream.h"
#include "coordinator/web/api/json_lists.h"
#include "coordinator/web/api/json_views.h"
#include "coordinator/web/api/picture_layers.h"
#include "coordinator/web/metrics_text.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

using nlohmann::json;

constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";
constexpr const char* kBusy = "the coordinator is busy";
constexpr int kDownloadsWaitingMax = 16;  // each may need the memory of a picture, one after the other
constexpr const char* kProbedCalls[] = {"Jobs.Submit", "Jobs.FetchPicture", "Jobs.Pause",
                                        "Jobs.DrainWorkers"};

HttpResponse Show(const json& value) {
  HttpResponse response = HttpResponse::Plain(200, JsonText(value) + "\n");
  response.type = kJsonText;
  return response;
}

HttpResponse Refuse(const WebError& error) {
  return HttpResponse::JsonError(error.status, error.reason);
}

HttpResponse Show(const WebResult<json>& result) {
  const auto* const error = std::get_if<WebError>(&result);
  return error != nullptr ? Refuse(*error) : Show(std::get<json>(result));
}

// Gives what `show` makes of a value, or the error.
template <typename Value, typename ShowValue>
WebDone<Value> GiveTo(std::shared_ptr<LaterAnswer> later, ShowValue show) {
  return [later, show](WebResult<Value> result) {
    later->Give([show, result = std::move(result)] {
      const auto* const error = std::get_if<WebError>(&result);
      return error != nullptr ? Refuse(*error) : Show(show(std::get<Value>(result)));
    });
  };
}

// Other users of this machine have their own number of streams.
std::string OwnerOf(const WebVisit& visit) {
  return MemberIdText(visit.visitor.member) + visit.visitor.name;
}

json ReachJson(WebReach reach) {
  return reach == WebReach::kEverything ? "all" : reach == WebReach::kOwn ? "own" : "none";
}

// One of a count while it exists.
class CountedPlace {
 public:
  explicit CountedPlace(std::atomic<int>& count) : count_(count) { ++count_; }
  ~CountedPlace() { --count_; }
  CountedPlace(const CountedPlace&) = delete;
  CountedPlace& operator=(const CountedPlace&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace

WebApi::WebApi(WebFarm farm)
    : farm_(std::move(farm)),
      watch_(farm_.view),
      boards_(farm_),
      events_(std::make_shared<EventSource>(watch_)) {}

WebApi::~WebApi() {
  Stop();
}

void WebApi::Stop() {
  boards_.Stop();
  watch_.Stop();
}

HttpResponse WebApi::Answer(const HttpRequest& request, const WebVisit& visit) {
  std::string methods;
  const auto match = FindRoute(request.method, request.path, methods);
  if (match) return AnswerRoute(request, *match, visit);
  if (!methods.empty()) return HttpResponse::Unsupported(methods);
  if (request.path.starts_with("/api/")) return HttpResponse::JsonError(404, "there is no such path");
  const bool is_metrics = request.path == "/metrics";
  if (!is_metrics && FindPageFile(request.path) == nullptr)
    return HttpResponse::Plain(404, "There is no such page.\n");
  if (request.method != "GET" && request.method != "HEAD") return HttpResponse::Unsupported("GET, HEAD");
  return is_metrics ? ShowMetrics() : ShowFile(request);
}

HttpResponse WebApi::Receive(const HttpRequest& request, const WebVisit& visit) {
  std::string methods;
  const auto match = FindRoute(request.method, request.path, methods);
  if (match && match->route->body != WebBody::kNumbers) return AnswerRoute(request, *match, visit);
  return WebContent::Receive(request, visit);
}

HttpResponse WebApi::ShowFile(const HttpRequest& request) {
  const PageFile& file = *FindPageFile(request.path);
  HttpResponse response = HttpResponse::Bytes(file.type, file.bytes);
  response.is_page = file.is_page;
  response.etag = file.etag;
  if (request.if_none_match == file.etag) {
    response.status = 304;
    response.body = std::make_shared<const std::string>();
  }
  return response;
}

HttpResponse WebApi::ShowMetrics() {
  const auto later = std::make_shared<LaterAnswer>();
  watch_.Ask([later](const FarmWatch::Moment& moment) {
    later->Give([moment] {
      if (moment == nullptr) return HttpResponse::Plain(503, "The coordinator is busy. Try again.\n");
      return HttpResponse::Bytes(kMetricsType,
                                 std::make_shared<const std::string>(MetricsText(moment->view)));
    });
  });
  return HttpResponse::Later(later);
}

HttpResponse WebApi::AnswerRoute(const HttpRequest& http, const WebRouteMatch& match, const WebVisit& visit) {
  const WebRoute& route = *match.route;
  if (const auto refused = farm_.admit({visit.visitor, visit.peer}, route.call)) return Refuse(*refused);
  if (route.body != WebBody::kNumbers) return TakeBody(http, match, visit);
  auto parameters = ReadParameters(http, route);
  if (const auto* const error = std::get_if<WebError>(&parameters)) return Refuse(*error);
  return Run({route, match.job, match.worker, std::get<Query>(std::move(parameters)), visit});
}

HttpResponse WebApi::TakeBody(const HttpRequest& http, const WebRouteMatch& match, const WebVisit& visit) {
  const auto made = MakeBodySink(farm_, http, match, {visit.visitor, visit.peer});
  if (const auto* const error = std::get_if<WebError>(&made)) return Refuse(*error);
  const auto sink = std::get<std::shared_ptr<BodySink>>(made);
  if (http.has_long_body()) {
    HttpResponse response = HttpResponse::Receive(sink);
    response.stream_owner = OwnerOf(visit);
    return response;
  }
  const auto later = std::make_shared<LaterAnswer>();
  sink->Take(http.body, true, later);
  return HttpResponse::Later(later);
}

HttpResponse WebApi::Run(const Request& request) {
  switch (request.route.action) {
    case WebAction::kMe: return ShowMe(request);
    case WebAction::kOpenApi: {
      const PageFile& file = *FindPageFile("/page/openapi.json");
      return HttpResponse::Bytes(file.type, file.bytes);
    }
    case WebAction::kFarm:
      return ShowFarm([](const FarmMoment& moment) { return WebResult<json>(FarmJson(moment)); });
    case WebAction::kHistory: return Show(HistoryJson(watch_.History()));
    case WebAction::kJobs:
      return ShowFarm(
          [query = request.query](const FarmMoment& moment) { return JobsJson(moment.view, query); });
    case WebAction::kWorkers:
      return ShowFarm([this, query = request.query](const FarmMoment& moment) {
        return WorkersJson(watch_, moment.view, query);
      });
    case WebAction::kJob: return ShowJob(request);
    case WebAction::kJobLog: return ShowJobLog(request);
    case WebAction::kChangeJob: return ChangeJob(request);
    case WebAction::kChangeWorkers: return ChangeWorkers(request);
    case WebAction::kEvents: return WatchFarm(request);
    case WebAction::kPicture:
    case WebAction::kExr:
    case WebAction::kPng:
    case WebAction::kThumbnail: return ShowPicture(request);
    case WebAction::kMissingBlobs:
    case WebAction::kOrderJob:
    case WebAction::kUploadBlob: break;  // TakeBody
  }
  return HttpResponse::JsonError(404, "there is no such path");
}

HttpResponse WebApi::ShowMe(const Request& request) const {
  const Visitor& visitor = request.visit.visitor;
  json may;
  for (const char* call : kProbedCalls) may[call] = ReachJson(farm_.reach(visitor, call));
  return Show(json{{"name", visitor.name},
                   {"role", visitor.role},
                   {"member", visitor.member != MemberId{} ? MemberIdText(visitor.member) : ""},
                   {"proof", request.visit.proof},
                   {"logout_proof", request.visit.logout_proof},
                   {"may", may},
                   {"version", kSoftwareVersion}});
}

HttpResponse WebApi::ShowFarm(std::function<WebResult<json>(const FarmMoment&)> show) {
  const auto later = std::make_shared<LaterAnswer>();
  watch_.Ask([later, show = std::move(show)](const FarmWatch::Moment& moment) {
    later->Give([moment, show] {
      return moment == nullptr ? HttpResponse::JsonError(503, kBusy) : Show(show(*moment));
    });
  });
  return HttpResponse::Later(later);
}

HttpResponse WebApi::ShowJob(const Request& request) {
  uint64_t frame = 0;
  if (!ReadNumber(request.query, "frame", kFramesPerJobMax, frame))
    return HttpResponse::JsonError(400, "frame: expected a number");
  const auto show = [moment = watch_.Latest()](const JobDetail& detail) {
    return DetailJson(detail, moment != nullptr ? &moment->view : nullptr);
  };
  const auto later = std::make_shared<LaterAnswer>();
  farm_.detail(request.job, static_cast<uint32_t>(frame), GiveTo<JobDetail>(later, show));
  return HttpResponse::Later(later);
}

HttpResponse WebApi::ShowJobLog(const Request& request) const {
  uint64_t after = 0, limit = kLogEntriesPerCallMax;
  if (!ReadNumber(request.query, "after", UINT64_MAX, after))
    return HttpResponse::JsonError(400, "after: expected a number");
  if (!ReadNumber(request.query, "limit", kLogEntriesPerCallMax, limit))
    return HttpResponse::JsonError(400,
                                   fmt::format("limit: expected a number up to {}", kLogEntriesPerCallMax));
  const auto page = farm_.log(request.job, after, limit);
  if (const auto* const error = std::get_if<WebError>(&page)) return Refuse(*error);
  return Show(JobLogJson(std::get<JobLogPage>(page)));
}

HttpResponse WebApi::ChangeJob(const Request& request) {
  JobChange change{request.route.call, request.job, 0};
  if (!request.route.parameters.empty()) {
    const auto value = request.query.find(std::string(request.route.parameters));
    if (value == request.query.end())
      return HttpResponse::JsonError(400, fmt::format("{}: missing", request.route.parameters));
    const std::string& text = value->second;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), change.value);
    if (error != std::errc() || end != text.data() + text.size())
      return HttpResponse::JsonError(400, fmt::format("{}: out of range", request.route.parameters));
  }
  const auto later = std::make_shared<LaterAnswer>();
  farm_.change_job(request.caller(), change, GiveTo<JobStatus>(later, JobJson));
  return HttpResponse::Later(later);
}

HttpResponse WebApi::ChangeWorkers(const Request& request) {
  using Workers = std::vector<WorkerStatus>;
  const auto show = [](const Workers& changed) {
    json workers = json::array();
    for (const WorkerStatus& worker : changed) workers.push_back(WorkerJson(worker));
    return json{{"workers", std::move(workers)}};
  };
  const auto later = std::make_shared<LaterAnswer>();
  farm_.change_workers(request.caller(), request.route.call, request.worker, GiveTo<Workers>(later, show));
  return HttpResponse::Later(later);
}

HttpResponse WebApi::WatchFarm(const Request& request) {
  uint64_t job = 0;
  if (!ReadNumber(request.query, "job", UINT64_MAX, job))
    return HttpResponse::JsonError(400, "job: expected a number");
  HttpResponse response = HttpResponse::Stream(
      "text/event-stream",
      std::make_shared<EventStream>(events_, job != 0 ? std::optional(JobId{job}) : std::nullopt));
  response.stream_owner = OwnerOf(request.visit);
  return response;
}

// Whether the caller may see the picture depends on the owner of the job.
HttpResponse WebApi::ShowPicture(const Request& request) {
  uint64_t number = 0, size = kSmallSize;
  if (!ReadNumber(request.query, "frame", kFramesPerJobMax, number))
    return HttpResponse::JsonError(400, "frame: expected a number");
  if (!ReadNumber(request.query, "size", kMediumSize, size) || (size != kSmallSize && size != kMediumSize))
    return HttpResponse::JsonError(400, fmt::format("size: expected {} or {}", kSmallSize, kMediumSize));
  const auto named = request.query.find("layer");
  const std::string layer = named != request.query.end() ? named->second : "";
  const FrameId frame{request.job, static_cast<uint32_t>(number)};
  const auto later = std::make_shared<LaterAnswer>();
  const WebAction action = request.route.action;
  const std::string owner = OwnerOf(request.visit);
  farm_.admit_to_job(
      request.caller(), request.route.call, frame.job, [=, this](const WebResult<JobStatus>& admitted) {
        if (const auto* const error = std::get_if<WebError>(&admitted)) return later->Give(Refuse(*error));
        if (frame.frame >= std::get<JobStatus>(admitted).frames_total)
          return later->Give(HttpResponse::JsonError(404, "the job has no such frame"));
        if (action == WebAction::kPicture) return StreamLayer(frame, layer, owner, later);
        if (action == WebAction::kThumbnail) {
          const auto png = boards_.Thumbnail(frame, static_cast<int>(size));
          return later->Give(png != nullptr
                                 ? HttpResponse::Bytes("image/png", png)
                                 : HttpResponse::JsonError(404, "the small picture is not made yet"));
        }
        if (waiting_ >= kDownloadsWaitingMax) {
          return later->Give(HttpResponse::JsonError(503, "too many pictures are waiting to be sent"));
        }
        farm_.run_later([=, this, place = std::make_shared<const CountedPlace>(waiting_)] {
          const auto made = GuardedResult(
              [&]() -> Result<HttpResponse> { return Download(frame, action == WebAction::kPng); });
          HttpResponse response = made ? *made : HttpResponse::JsonError(503, made.error().message);
          response.stream_owner = owner;
          later->Give(std::move(response));
        });
      });
  return HttpResponse::Later(later);
}

// Every frame has colours; of another layer it is asked first.
void WebApi::StreamLayer(FrameId frame, const std::string& layer, const std::string& owner,
                         const std::shared_ptr<LaterAnswer>& later) {
  const auto stream = [=, this] {
    const auto body = boards_.Watch(frame, layer);
    if (const auto* const error = std::get_if<WebError>(&body)) return later->Give(Refuse(*error));
    HttpResponse response =
        HttpResponse::Stream("application/octet-stream", std::get<std::shared_ptr<BodyStream>>(body));
    response.stream_owner = owner;
    later->Give(std::move(response));
  };
  if (layer.empty()) return stream();
  farm_.detail(frame.job, frame.frame, [=](const WebResult<JobDetail>& found) {
    if (const auto* const error = std::get_if<WebError>(&found)) return later->Give(Refuse(*error));
    const auto& spec = std::get<JobDetail>(found).spec;
    if (spec == nullptr || !FindLayer(spec->frames[frame.frame].spec, layer))
      return later->Give(HttpResponse::JsonError(404, "the frame has no such layer"));
    stream();
  });
}

// The EXR file of a finished frame, or what there is of another.
HttpResponse WebApi::Download(FrameId frame, bool is_png) const {
  const auto asked = farm_.frame(frame.job, frame.frame);
  if (const auto* const error = std::get_if<WebError>(&asked)) return Refuse(*error);
  const FrameState& state = std::get<FrameState>(asked);
  auto opened = OpenPicture(farm_, frame, state, is_png);
  if (const auto* const error = std::get_if<WebError>(&opened)) return Refuse(*error);
  auto& file = std::get<ReadableFile>(opened);
  const uint64_t size = file.size();
  HttpResponse response = HttpResponse::Stream(is_png ? "image/png" : "image/x-exr",
                                               std::make_shared<FileStream>(std::move(file)));
  response.stream_size = size;
  const int32_t number = state.spec->frames[frame.frame].number;
  const std::string suffix = state.spec->frames.size() > 1 ? fmt::format(".{:04}", number) : "";
  response.file_name = fmt::format("job-{}{}{}", Number(frame.job), suffix, is_png ? ".png" : ".exr");
  return response;
}

}  // namespace tessera
