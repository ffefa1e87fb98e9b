// An answer to an HTTP request.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

inline constexpr const char* kPlainText = "text/plain; charset=utf-8";
inline constexpr const char* kJsonText = "application/json";
inline constexpr int kContinue = 100;  // status

class BodySink;
class BodyStream;
class LaterAnswer;

struct HttpResponse {
  int status = 200;
  std::string type = kPlainText;
  std::shared_ptr<const std::string>
      body;                    // null only with `stream` or `later`; may be shared by many answers
  std::string style = {};      // the only style sheet that the page may contain
  std::string location = {};   // of a redirection
  std::string cookie = {};     // to set: name, value and attributes
  bool is_for_member = false;  // whether whoever asked is one
  bool is_page = false;        // whether the document may run scripts and load styles and data of this server
  std::string etag = {};       // names the version of a body that browsers may keep and ask about again
  std::string file_name = {};  // under which browsers store the body: ASCII without quotes
  std::string allow = {};      // with 405: the methods that are supported
  std::shared_ptr<BodyStream> stream = {};   // makes the body while it is sent
  std::optional<uint64_t> stream_size = {};  // in bytes, if it is known
  std::shared_ptr<BodySink> sink = {};       // takes the body of the request, then gives the answer
  // Who has the stream or sends the body: each may have a bounded number of them.
  std::string stream_owner = {};
  std::shared_ptr<LaterAnswer> later = {};  // gives the answer that takes the place of this one

  static HttpResponse Plain(int status, std::string text);
  static HttpResponse Html(int status, std::string page, std::string style);
  static HttpResponse Bytes(std::string type, std::shared_ptr<const std::string> bytes);
  // An object with the member "error".
  static HttpResponse JsonError(int status, const std::string& reason);
  static HttpResponse Unsupported(const std::string& methods);
  // To a GET of this path.
  static HttpResponse Redirect(std::string path);
  static HttpResponse Stream(std::string type, std::shared_ptr<BodyStream> stream);
  static HttpResponse Later(std::shared_ptr<LaterAnswer> later);
  static HttpResponse Receive(std::shared_ptr<BodySink> sink);
  // Of a BodySink: it can take another piece.
  static HttpResponse Continue();
  bool IsContinue() const { return status == kContinue; }

  // Status line and headers, up to and including the empty line. Every answer forbids browsers to load, run,
  // frame or store anything besides what it names.
  std::string Head() const;
};

// A body whose end is not known when its head is sent. Used by the thread of the server alone.
class BodyStream {
 public:
  using Part = std::shared_ptr<const std::string>;
  enum class Next { kParts, kLater, kEnd };
  virtual ~BodyStream() = default;
  // Adds what there is to send now to `parts`. Called when everything before is sent, and several times per
  // second while there is nothing.
  virtual Next Take(std::vector<Part>& parts) = 0;
};

// An answer that another thread gives. Thread safe.
class LaterAnswer {
 public:
  // The first call counts. `make` runs in Take: whoever gives an answer, such as the core thread, spends no
  // time on writing it.
  void Give(std::function<HttpResponse()> make);
  void Give(HttpResponse response);
  // `notify` is called when the answer is there, from any thread or within this call.
  void OnGiven(const std::function<void()>& notify);
  // Makes the answer, once, and returns what `finish` makes of it.
  std::optional<HttpResponse> Take();
  // Set before the answer is taken, by the thread that takes it.
  void SetFinish(std::function<HttpResponse(HttpResponse)> finish) { finish_ = std::move(finish); }

 private:
  std::function<HttpResponse(HttpResponse)> finish_;
  std::mutex mutex_;
  bool is_given_ = false;
  std::function<HttpResponse()> make_;
  std::function<void()> notify_;
};

// Takes a body that is too long to be kept, in pieces while it arrives. If it is destroyed before it has
// given the answer, the rest of the body does not come. Used by the thread of the server, one piece after the
// other.
class BodySink {
 public:
  virtual ~BodySink() = default;
  // Takes the next piece, of at least kBodyPieceBytes unless it is the last. Gives Continue() when it can
  // take another, or the answer to the request: after the last piece, or earlier if it refuses the rest.
  virtual void Take(std::string piece, bool is_last, std::shared_ptr<LaterAnswer> answer) = 0;
};
// Each upload keeps up to two pieces in memory, one that arrives and one that is stored.
constexpr size_t kBodyPieceBytes = 128 << 10;

}  // namespace tessera
