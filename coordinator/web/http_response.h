// An answer to an HTTP request.
#pragma once

#include <memory>
#include <string>

namespace tessera {

inline constexpr const char* kPlainText = "text/plain; charset=utf-8";

struct HttpResponse {
  int status = 200;
  std::string type = kPlainText;
  std::shared_ptr<const std::string> body;  // never null; may be shared by many answers
  std::string style;                        // the only style sheet that the page may contain
  std::string location;                     // of a redirection
  std::string cookie;                       // to set: name, value and attributes
  bool is_for_member = false;               // whether whoever asked is one

  static HttpResponse Plain(int status, std::string text);
  static HttpResponse Html(int status, std::string page, std::string style);
  // To a GET of this path.
  static HttpResponse Redirect(std::string path);

  // Status line and headers, up to and including the empty line. Every answer forbids browsers to load, run,
  // frame or store anything besides the style sheet.
  std::string Head() const;
};

}  // namespace tessera
