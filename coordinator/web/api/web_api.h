// Everything that members see: the page and its files, metrics for Prometheus, and the interface for programs
// under /api/v1 (routes.h).
#pragma once

#include <atomic>
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "coordinator/web/api/event_stream.h"
#include "coordinator/web/api/farm_watch.h"
#include "coordinator/web/api/parameters.h"
#include "coordinator/web/api/picture_boards.h"
#include "coordinator/web/api/routes.h"
#include "coordinator/web/api/web_farm.h"
#include "coordinator/web/web_content.h"

namespace tessera {

// Thread safe.
class WebApi final : public WebContent {
 public:
  explicit WebApi(WebFarm farm);
  ~WebApi() override;
  // Ends its threads. Streams end, and what is asked later is refused.
  void Stop();

  HttpResponse Answer(const HttpRequest& request, const WebVisit& visit) override;
  HttpResponse Receive(const HttpRequest& request, const WebVisit& visit) override;

 private:
  // A request of the interface.
  struct Request {
    const WebRoute& route;
    JobId job{};
    std::string worker;
    Query query;  // or the members of the body
    WebVisit visit;
    WebCaller caller() const { return {visit.visitor, visit.peer}; }
  };
  static HttpResponse ShowFile(const HttpRequest& request);
  HttpResponse ShowMetrics();
  HttpResponse AnswerRoute(const HttpRequest& http, const WebRouteMatch& match, const WebVisit& visit);
  HttpResponse Run(const Request& request);
  // Takes the body of a request in pieces, or the whole of it that is there already.
  HttpResponse TakeBody(const HttpRequest& http, const WebRouteMatch& match, const WebVisit& visit);
  HttpResponse ShowMe(const Request& request) const;
  // `show` makes an answer of the farm as it is now, later.
  HttpResponse ShowFarm(std::function<WebResult<nlohmann::json>(const FarmMoment&)> show);
  HttpResponse ShowJob(const Request& request);
  HttpResponse ShowJobLog(const Request& request) const;
  HttpResponse ChangeJob(const Request& request);
  HttpResponse ChangeWorkers(const Request& request);
  HttpResponse WatchFarm(const Request& request);
  HttpResponse ShowPicture(const Request& request);
  void StreamLayer(FrameId frame, const std::string& layer, const std::string& owner,
                   const std::shared_ptr<LaterAnswer>& later);
  HttpResponse Download(FrameId frame, bool is_png) const;

  const WebFarm farm_;
  FarmWatch watch_;
  PictureBoards boards_;
  const std::shared_ptr<EventSource> events_;
  std::atomic<int> waiting_{0};  // downloads that are being made
};

}  // namespace tessera
