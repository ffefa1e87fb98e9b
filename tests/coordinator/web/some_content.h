// Content for tests of the web server and of who gets in.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "coordinator/web/html.h"
#include "coordinator/web/web_content.h"

namespace tessera {

// A stream that sends a line whenever it is asked.
class EndlessStream final : public BodyStream {
 public:
  explicit EndlessStream(std::atomic<int>& open, size_t bytes) : open_(open), line_(Line(bytes)) { ++open_; }
  ~EndlessStream() override { --open_; }
  Next Take(std::vector<Part>& parts) override {
    parts.push_back(line_);
    return line_->size() > 100 ? Next::kParts : Next::kLater;
  }

 private:
  static Part Line(size_t bytes) {
    return std::make_shared<const std::string>(std::string(bytes, 'x') + "\n");
  }
  std::atomic<int>& open_;
  const Part line_;
};

// "/" is a page that names the visitor, "/metrics" a text, "/change" a change, "/stream" and "/flood" streams
// without an end, "/later" an answer from another thread and "/never" one that is not given.
class SomeContent final : public WebContent {
 public:
  HttpResponse Answer(const HttpRequest& request, const WebVisit& visit) override {
    const bool is_get = request.method == "GET" || request.method == "HEAD";
    if (request.path == "/change") {
      if (is_get) return HttpResponse::Unsupported("POST");
      ++changes;
      return HttpResponse::Plain(200, "changed");
    }
    if (request.path == "/proof") return HttpResponse::Plain(200, visit.proof);
    if (request.path == "/stream" || request.path == "/flood") {
      auto response = HttpResponse::Stream(
          "text/event-stream",
          std::make_shared<EndlessStream>(open_streams, request.path == "/flood" ? 65536 : 1));
      response.stream_owner = visit.visitor.name;
      return response;
    }
    if (request.path == "/never") return HttpResponse::Later(std::make_shared<LaterAnswer>());
    if (request.path == "/later") {
      const auto later = std::make_shared<LaterAnswer>();
      std::thread([later] { later->Give(HttpResponse::Plain(200, "later")); }).detach();
      return HttpResponse::Later(later);
    }
    if (request.path != "/" && request.path != "/metrics")
      return HttpResponse::Plain(404, "There is no such page.\n");
    if (!is_get) return HttpResponse::Unsupported("GET, HEAD");
    if (request.path == "/metrics") return HttpResponse::Plain(200, "tessera_workers 0\n");
    Html html;
    html.Element("p", fmt::format("{} ({})", visit.visitor.name, visit.visitor.role));
    if (!visit.logout_proof.empty()) {
      html.Void("input", {{"name", "proof"}, {"value", visit.logout_proof}});
      html.Element("button", "Log out");
    }
    HttpResponse page = HttpResponse::Plain(200, html.Take());
    page.type = "text/html; charset=utf-8";
    page.is_page = true;
    return page;
  }

  std::atomic<int> changes{0}, open_streams{0};
};

}  // namespace tessera
