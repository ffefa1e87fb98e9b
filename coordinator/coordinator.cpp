#include "coordinator/coordinator.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <thread>

#include "coordinator/access_service.h"
#include "coordinator/ask_core.h"
#include "coordinator/blob_service.h"
#include "coordinator/call_gate.h"
#include "coordinator/core_thread.h"
#include "coordinator/job_log.h"
#include "coordinator/jobs_service.h"
#include "coordinator/listener/listener.h"
#include "coordinator/listener/pending_connections.h"
#include "coordinator/membership/farm_identity.h"
#include "coordinator/membership/organisation.h"
#include "coordinator/membership/peer_check.h"
#include "coordinator/public_addresses.h"
#include "coordinator/read_farm_view.h"
#include "coordinator/recovery.h"
#include "coordinator/server.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/store/file_pictures.h"
#include "coordinator/task_pool.h"
#include "coordinator/web/api/web_api.h"
#include "coordinator/web/web_server.h"
#include "coordinator/web_access.h"
#include "coordinator/web_calls.h"
#include "coordinator/work_service.h"
#include "proto/shell/pause.h"
#include "proto/shell/program.h"
#include "proto/wire/local_socket.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// How soon certificates of an organisation that were replaced are shown; gRPC adds up to 10 s.
constexpr std::chrono::seconds kCertificatesInterval{5};

bool HasTcpAddress(const CoordinatorOptions& options) {
  return options.https.has_value() || std::ranges::any_of(options.listen, [](const Address& each) {
           return each.kind == Address::Kind::kTcp;
         });
}

}  // namespace

// In the order in which they are made; each may use those above it.
struct Coordinator::Parts {
  Parts(DataDir data_dir, BlobStore blob_store)
      : directory(std::move(data_dir)),
        blobs(std::move(blob_store)),
        pictures(directory.PicturesPath()),
        job_log(directory.MessagesPath(),
                [this](std::function<void()> task) { files.lengthy.Post(std::move(task)); }) {}

  Result<void> Recover(const CoordinatorOptions& options);
  Result<void> OpenIdentity(const CoordinatorOptions& options);
  Result<void> Serve(const CoordinatorOptions& options, AccessPolicy policy);
  Result<void> ServeWeb(const CoordinatorOptions& options, const AccessPolicy& policy);
  ServerSecurity Security() const;
  void RefreshCertificates(const std::vector<std::string>& names);
  std::optional<FarmView> ViewFarm();
  void ProbePictures();

  DataDir directory;
  BlobStore blobs;
  FilePictures pictures;
  TaskPool spooling{1};
  FileThreads files;
  JobLog job_log;
  FarmId farm;
  std::unique_ptr<CoreThread> core;
  const std::shared_ptr<PendingConnections> pending = std::make_shared<PendingConnections>();
  std::unique_ptr<CallGate> gate;
  std::unique_ptr<WorkService> work;
  std::unique_ptr<BlobService> blob_service;
  std::unique_ptr<JobsService> jobs;
  std::optional<FarmIdentity> identity;        // if TCP connections are encrypted
  std::shared_ptr<Organisation> organisation;  // if it has certificates
  std::unique_ptr<AccessService> access;
  TaskPool downloads{1};        // that web pages ask for
  std::shared_ptr<WebApi> api;  // if there are web pages
  std::unique_ptr<WebServer> web, encrypted_web;
  std::unique_ptr<CoordinatorServer> server;
  std::string certificates_problem;  // of the thread below
  std::jthread certificates;         // keeps them usable
};

Result<void> Coordinator::Parts::Recover(const CoordinatorOptions& options) {
  blobs.Protect(
      [this] { return AskCore(*core, [](CoreContext& context) { return context.farm.PackagesInUse(); }); });
  auto recovered = tessera::Recover(directory, {options.attempts_max, options.keep_sums_bytes},
                                    [this](std::function<void()> task) { spooling.Post(std::move(task)); });
  if (!recovered) return recovered.error();
  for (const std::string& line : recovered->log) spdlog::warn("{}", line);
  farm = recovered->farm->id();
  if (const std::string problem = job_log.Restore(recovered->farm->Jobs(Instant{})); !problem.empty())
    spdlog::warn("job_log_lost reason={}", LogText(problem));
  core = std::make_unique<CoreThread>(CoreThread::Parts{
      std::move(recovered->farm), std::move(recovered->journal), std::move(recovered->spool),
      std::make_unique<PictureWriter>(pictures), [this](const FarmOutput& output) { job_log.Note(output); },
      [this] { files.lengthy.Post([this] { blobs.FreeReserve(); }); }, [this] { return blobs.IsDiskLow(); }});
  ProbePictures();
  return {};
}

Result<void> Coordinator::Parts::OpenIdentity(const CoordinatorOptions& options) {
  if (options.insecure || !HasTcpAddress(options)) return {};
  ExpectedAuthority expected;
  if (!options.start_afresh) expected = {core->members().HasMembers(), core->members().authority()};
  const std::vector<std::string> names = options.names.empty() ? NamesOfThisMachine() : options.names;
  auto opened = FarmIdentity::Open(directory.IdentityPath(), names, UnixNow(), expected);
  if (!opened) return opened.error();
  core->Post([fingerprint = opened->authority().certificate().Fingerprint()](CoreContext& context) {
    context.farm.membership().ChooseAuthority(fingerprint);
  });
  if (opened->is_new())
    spdlog::info("authority_made fingerprint={}", opened->authority().certificate().Fingerprint().Hex());
  identity = std::move(*opened);
  if (options.tls.IsUsed()) {
    const std::string path = directory.IdentityPath() + "/shown.pem";
    auto made = Organisation::Open(options.tls, identity->authority(), path, UnixNow());
    if (!made) return made.error();
    organisation = std::move(*made);
    identity->ShowOther(path);
  }
  certificates = std::jthread([this, names](std::stop_token stop) {
    while (Pause(stop, kCertificatesInterval)) RefreshCertificates(names);
  });
  return {};
}

// Errors are logged again only when they change: files that are being replaced differ for a moment. An
// authority that is missing is not made anew while members trust it.
void Coordinator::Parts::RefreshCertificates(const std::vector<std::string>& names) {
  std::string problem = "the key of the farm's authority is missing";
  if (FarmIdentity::Exists(directory.IdentityPath())) {
    const auto own = FarmIdentity::Open(directory.IdentityPath(), names, UnixNow());
    problem = own ? "" : own.error().message;
  }
  const auto others = organisation != nullptr ? organisation->Refresh(UnixNow()) : Result<bool>(false);
  if (others && *others) spdlog::info("certificates_read_again");
  if (!others) problem = others.error().message;
  if (problem != certificates_problem && !problem.empty())
    spdlog::warn("certificates_not_refreshed reason={}", LogText(problem));
  certificates_problem = problem;
}

ServerSecurity Coordinator::Parts::Security() const {
  ServerSecurity security;
  security.socket_folder = LocalSocketFolder(Environment);
  if (!identity) return security;
  security.identity_path = identity->coordinator_path();
  security.pending = pending;
  security.admit = [authority = identity->authority().certificate(), others = organisation,
                    board = core->shared_members()](const std::vector<Certificate>& chain) {
    return CheckPeer(chain, authority, others != nullptr ? others->authorities() : std::vector<Certificate>(),
                     *board, UnixNow());
  };
  return security;
}

Result<void> Coordinator::Parts::ServeWeb(const CoordinatorOptions& options, const AccessPolicy& policy) {
  const auto start = [&](const Address& address, std::optional<WebTls> tls, std::optional<WebGate> people,
                         std::unique_ptr<WebServer>& place) -> Result<void> {
    auto site = std::make_unique<WebSite>(options.http_names, api, std::move(people));
    auto started = WebServer::Start(address, std::move(tls), std::move(site));
    if (!started) return started.error();
    place = std::move(*started);
    return {};
  };
  if (options.http || options.https) {
    api = std::make_shared<WebApi>(
        MakeWebFarm({*gate, blobs, pictures, job_log, downloads, files, blob_service->load(), policy,
                     options.insecure, [this] { return ViewFarm(); }}));
  }
  if (options.http) {
    if (auto started = start(*options.http, {}, {}, web); !started) return started;
  }
  if (!options.https || !identity) return {};
  const ServerSecurity security = Security();
  std::vector<Certificate> authorities{identity->authority().certificate()};
  if (organisation != nullptr) {
    for (Certificate& each : organisation->authorities()) authorities.push_back(std::move(each));
  }
  return start(*options.https,
               WebTls{security.identity_path, security.identity_path, authorities, security.admit},
               MakeWebGate(*gate, {*core, files.brief, directory}, policy), encrypted_web);
}

Result<void> Coordinator::Parts::Serve(const CoordinatorOptions& options, AccessPolicy policy) {
  const AccessPolicy web_policy = policy;
  gate = std::make_unique<CallGate>(ChangePath{*core, files.brief, directory}, farm, std::move(policy),
                                    [this](std::string_view peer) { pending->Identified(peer); });
  work = std::make_unique<WorkService>(*gate);
  blob_service = std::make_unique<BlobService>(*gate, blobs, files);
  jobs = std::make_unique<JobsService>(*gate, blobs, pictures, job_log, files);
  if (auto serving = ServeWeb(options, web_policy); !serving) return serving;
  auto listener = Listener::Open(options.listen);
  if (!listener) return listener.error();
  const bool has_names = !options.names.empty();
  access = std::make_unique<AccessService>(
      *gate, identity ? &identity->authority() : nullptr,
      PublicAddresses((*listener)->addresses(), has_names ? options.names : NamesOfThisMachine(), has_names));
  auto started = CoordinatorServer::Start(std::move(*listener), Security(),
                                          {work.get(), blob_service.get(), jobs.get(), access.get()});
  if (!started) return started.error();
  server = std::move(*started);
  return {};
}

// Finds pictures that were cut or removed while no coordinator was running. Their bytes are compared when
// they are fetched.
void Coordinator::Parts::ProbePictures() {
  core->Post([this](CoreContext& context) {
    spooling.Post([this, files = context.farm.FinishedFiles()] {
      for (const auto& [id, file] : files) {
        const auto probed = pictures.Probe(id.job, id.frame, file);
        if (probed) continue;
        core->Post([id = id, reason = probed.error().message](CoreContext& now) {
          now.farm.PictureDamaged(id, reason);
        });
      }
    });
  });
}

std::optional<FarmView> Coordinator::Parts::ViewFarm() {
  auto view = ReadFarmView(*core);
  if (!view) return view;
  view->traffic = {work->bytes_in(), blob_service->bytes_in(), blob_service->bytes_out()};
  view->intake = {work->intake().bytes(), work->intake().waiting()};
  view->blob_bytes = blobs.bytes();
  struct statvfs disk {};
  if (::statvfs(directory.PicturesPath().c_str(), &disk) == 0) {
    view->disk_free = disk.f_bavail * disk.f_frsize;
    view->disk_total = disk.f_blocks * disk.f_frsize;
  }
  return view;
}

Result<std::unique_ptr<Coordinator>> Coordinator::Start(const CoordinatorOptions& options,
                                                        AccessPolicy policy) {
  auto directory = DataDir::Open(
      options.data_dir, options.start_afresh ? DataDir::Journal::kMayBeGone : DataDir::Journal::kRequired);
  if (!directory) return directory.error();
  auto blobs = BlobStore::Open(directory->BlobsPath(), BlobStoreOptions::Origin(options.blob_bytes));
  if (!blobs) return blobs.error();
  auto parts = std::make_unique<Parts>(std::move(*directory), std::move(*blobs));
  std::unique_ptr<Coordinator> coordinator(new Coordinator(std::move(parts)));
  if (auto recovered = coordinator->parts_->Recover(options); !recovered) return recovered.error();
  if (auto opened = coordinator->parts_->OpenIdentity(options); !opened) return opened.error();
  if (auto serving = coordinator->parts_->Serve(options, std::move(policy)); !serving) return serving.error();
  return coordinator;
}

Coordinator::Coordinator(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Coordinator::~Coordinator() {
  Stop();
}

const std::vector<Address>& Coordinator::addresses() const {
  return parts_->server->addresses();
}

std::optional<Digest> Coordinator::authority_fingerprint() const {
  if (!parts_->identity) return std::nullopt;
  return parts_->identity->authority().certificate().Fingerprint();
}

std::optional<Address> Coordinator::http() const {
  return parts_->web != nullptr ? std::optional(parts_->web->address()) : std::nullopt;
}

std::optional<Address> Coordinator::https() const {
  return parts_->encrypted_web != nullptr ? std::optional(parts_->encrypted_web->address()) : std::nullopt;
}

const BlobStore& Coordinator::blobs() const {
  return parts_->blobs;
}

size_t Coordinator::pending_connections() const {
  return parts_->pending->size();
}

size_t Coordinator::watcher_count() const {
  return parts_->core->watcher_count();
}

const ResultsIntake& Coordinator::intake() const {
  return parts_->work->intake();
}

// First the calls that wait, then no new ones, then what their answers need. Start may have stopped half-way.
void Coordinator::Stop() {
  Parts& parts = *parts_;
  parts.certificates.request_stop();
  for (WebServer* const each : {parts.web.get(), parts.encrypted_web.get()}) {
    if (each != nullptr) each->Stop();
  }
  if (parts.api != nullptr) parts.api->Stop();
  parts.downloads.Stop();
  if (parts.core != nullptr) parts.core->Close();
  if (parts.server != nullptr) parts.server->Shutdown();
  if (parts.jobs != nullptr) parts.jobs->Stop();
  parts.files.Stop();
  if (parts.core != nullptr) parts.core->Stop();
  parts.spooling.Stop();
  parts.job_log.Flush();
}

}  // namespace tessera
