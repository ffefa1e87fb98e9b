// What members see once the site knows who they are.
#pragma once

#include <string>

#include "coordinator/web/http_request.h"
#include "coordinator/web/http_response.h"
#include "coordinator/web/web_gate.h"

namespace tessera {

// Who makes a request, and from where.
struct WebVisit {
  Visitor visitor;
  std::string peer;          // the address of the connection, for logs
  std::string proof;         // that requests which change something must carry
  std::string logout_proof;  // for the form that logs out; empty: there is nothing to end
};

// Used by the threads of several servers. Requests with another method than GET and HEAD were sent by a page
// of this server, or by a program that has read the proof.
class WebContent {
 public:
  virtual ~WebContent() = default;
  virtual HttpResponse Answer(const HttpRequest& request, const WebVisit& visit) = 0;
  // The same for a request whose body is too long to be kept: an answer with a sink takes it, any other
  // refuses it.
  virtual HttpResponse Receive(const HttpRequest&, const WebVisit&) {
    return HttpResponse::Plain(413, "The request is too long.\n");
  }
};

}  // namespace tessera
