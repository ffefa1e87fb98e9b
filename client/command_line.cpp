#include "client/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdlib>

#include "client/option_values.h"
#include "proto/terms.h"
#include "renderer/accelerator/accelerator.h"
#include "renderer/film/adaptive.h"
#include "renderer/integrator/integrator_kinds.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// The value, or the error in the way CLI11 wants to hear of it.
template <typename T>
T Take(Result<T> result) {
  if (!result) throw CLI::ValidationError(result.error().message);
  return std::move(result).value();
}

// Adds a flag with one word that `set` turns into a value.
template <typename Set>
CLI::Option* AddWord(CLI::App& app, const std::string& flag, const std::string& help, const std::string& kind,
                     Set set) {
  return app
      .add_option_function<std::string>(
          flag, [set](const std::string& word) { set(word); }, help)
      ->type_name(kind);
}

void AddInteger(CLI::App& app, const std::string& flag, const std::string& help, int min, int max,
                int& target) {
  AddWord(app, flag, help, "N", [flag, min, max, &target](const std::string& word) {
    target = static_cast<int>(Take(ParseInteger(flag, word, min, max)));
  });
}

// What DESIGN.md promises and is not there yet is refused by name, not as an unknown flag.
void AddFutureFlags(CLI::App& app) {
  for (const char* flag : {"--camera"}) {
    app.add_option_function<std::string>(
           flag,
           [flag](const std::string&) {
             throw CLI::ValidationError(fmt::format("{} is not supported yet", flag));
           })
        ->group("");
  }
}

void AddFrames(CLI::App& app, Options& options) {
  AddWord(app, "--frames",
          "frames of a sequence, each from its own file if SCENE has a place for the number "
          "(scene.####.pbrt), else of "
          "the one animated scene",
          "A-B[xSTEP]",
          [&options](const std::string& word) { options.frames = Take(ParseFrameRange(word)); });
  AddWord(app, "--fps",
          "frames per second of an animated scene [default: 24]: frame N shows it at N / fps seconds", "F",
          [&options](const std::string& word) {
            options.fps = Take(ParseNumber("--fps", word, kFramesPerSecondMin));
          });
}

void AddNoiseOptions(CLI::App& app, RenderOptions& render) {
  AddWord(
      app, "--noise-threshold",
      fmt::format("stop each pixel once the root of the relMSE expected of it is below E x sqrt(n / {}) at n "
                  "samples per pixel; 0.2 is a draft, 0.05 clean [default: 0, all samples everywhere]",
                  kThresholdSamples),
      "E", [&render](const std::string& word) {
        render.noise_threshold = Take(ParseNumber("--noise-threshold", word, 0, kNoiseThresholdMax));
      });
}

CLI::Option* AddSamples(CLI::App& app, RenderOptions& render) {
  return AddWord(app, "--spp", "samples per pixel; with --noise-threshold at most", "N",
                 [&render](const std::string& word) {
                   render.samples_per_pixel =
                       static_cast<uint32_t>(Take(ParseUnsigned("--spp", word, 1, kSamplesPerPixelMax)));
                 });
}

void AddRenderOptions(CLI::App& app, Options& options) {
  RenderOptions& render = options.render;
  AddFrames(app, options);
  AddSamples(app, render);
  AddWord(app, "--resolution", "size of the picture, pixels", "WxH", [&render](const std::string& word) {
    const auto [width, height] = Take(ParseResolution(word));
    render.width = width;
    render.height = height;
  });
  AddWord(app, "--crop", "part of the picture to render, fractions", "x0,x1,y0,y1",
          [&render](const std::string& word) { render.crop = Take(ParseCrop(word)); });
  AddWord(app, "--seed", "of the random numbers", "S",
          [&render](const std::string& word) { render.seed = Take(ParseUnsigned("--seed", word)); });
  app.add_option("--integrator", render.integrator,
                 fmt::format("one of: {}", fmt::join(Integrators().Names(), ", ")))
      ->type_name("NAME");
  AddWord(app, "--accelerator", "embree (default), bvh or list", "NAME", [&render](const std::string& word) {
    render.accelerator = Take(ParseChoice("--accelerator", word, kAcceleratorKinds));
  });
  AddWord(app, "--max-depth", "longest path, bounces", "N", [&render](const std::string& word) {
    render.max_depth = static_cast<int>(Take(ParseInteger("--max-depth", word, 0, kPathDepthMax)));
  });
  AddWord(app, "--tile-size", fmt::format("pixels along the side of a tile [default: {}]", kTileSizeDefault),
          "N", [&render](const std::string& word) {
            render.tile_size = static_cast<int>(Take(ParseInteger("--tile-size", word, 1, kTileSizeMax)));
          });
  AddWord(app, "--exr-type", "half (default) or float", "TYPE",
          [&render](const std::string& word) { render.exr_type = Take(ParseExrType(word)); });
  AddNoiseOptions(app, render);
  AddWord(app, "--aov", fmt::format("channels to add to the picture, of: {}", fmt::join(kAovs, ", ")), "LIST",
          [&render](const std::string& word) { render.aovs = Take(ParseNames("--aov", word, kAovs)); });
  AddFutureFlags(app);
}

void AddVerify(CLI::App& app, Options& options) {
  AddWord(
      app, "--verify", "let two workers render this share of the picture, and compare them bit for bit", "P%",
      [&options](const std::string& word) { options.verify_share = Take(ParsePercent("--verify", word)); });
}

void AddCoordinator(CLI::App& app, Options& options) {
  app.add_option("--coordinator", options.coordinator,
                 fmt::format("HOST:PORT or unix:PATH [default: $TESSERA_COORDINATOR or {}]",
                             kCoordinatorAddressDefault))
      ->type_name("ADDR");
  AddWord(app, "--patience",
          fmt::format("how long to wait for a coordinator that does not answer, seconds [default: {}]",
                      kPatienceDefault.count()),
          "N", [&options](const std::string& word) {
            options.patience =
                std::chrono::seconds(Take(ParseInteger("--patience", word, 0, kPatienceMax_s)));
          });
}

void AddJob(CLI::App& app, Options& options) {
  app.add_option_function<std::string>(
         "JOB", [&options](const std::string& word) { options.job = Take(ParseUnsigned("JOB", word, 1)); },
         "number of the job, as submit printed it")
      ->required();
}

void AddPriority(CLI::App& app, Options& options) {
  app.add_option_function<std::string>(
         "N",
         [&options](const std::string& word) {
           options.priority = static_cast<int>(Take(ParseInteger("N", word, -kPriorityMax, kPriorityMax)));
         },
         "the priority from now on: higher goes first")
      ->required();
}

void AddOutput(CLI::App& app, Options& options, const std::string& default_name) {
  app.add_option(
         "-o,--output", options.output,
         fmt::format("the EXR to write, of a sequence with #### for the number [default: {}]", default_name))
      ->type_name("FILE");
  app.add_option("--png", options.png, "leave a tone-mapped 8-bit copy as well")->type_name("FILE");
}

void AddScene(CLI::App& app, Options& options) {
  app.add_option("SCENE", options.scene, "scene file (pbrt-v4)")->required();
}

CLI::App& AddCommand(CLI::App& app, Options& options, const std::string& name, const std::string& help) {
  CLI::App* command = app.add_subcommand(name, help);
  command->allow_extras();  // reported with a suggestion
  command->add_flag("--json", options.json, "answer in JSON");
  command->callback([&options, name] { options.command = name; });
  return *command;
}

void AddLocalCommands(CLI::App& app, Options& options) {
  CLI::App& render = AddCommand(app, options, "render", "render a scene on a farm of processes on this box");
  AddScene(render, options);
  AddOutput(render, options, "SCENE's name with .exr");
  AddInteger(render, "--workers", "worker processes [default: 1]", 1, kWorkersMax, options.workers);
  AddInteger(render, "--threads", "render threads of each [default: all cores, shared]", 1, kWorkersMax,
             options.threads);
  render.add_flag("--in-process", options.in_process, "render in this process, without any farm");
  AddVerify(render, options);
  AddRenderOptions(render, options);

  CLI::App& compare = AddCommand(app, options, "compare", "compare two EXR pictures");
  compare.add_option("A", options.picture_a, "the picture")->required();
  compare.add_option("B", options.picture_b, "the reference")->required();
  AddWord(
      compare, "--tolerance", "largest difference of two values that passes [default: 0]", "E",
      [&options](const std::string& word) { options.tolerance = Take(ParseNumber("--tolerance", word, 0)); });

  CLI::App& info = AddCommand(app, options, "info", "say what a scene holds");
  AddScene(info, options);
  AddRenderOptions(info, options);
}

void AddRequire(CLI::App& app, Options& options) {
  app.add_option_function<std::vector<std::string>>(
         "--require",
         [&options](const std::vector<std::string>& words) {
           for (const std::string& word : words)
             options.required_tags.insert(Take(ParseTag("--require", word)));
           if (options.required_tags.size() > kTagsMax) {
             throw CLI::ValidationError(fmt::format("--require: more than {} tags", kTagsMax));
           }
         },
         "only workers with this tag may work for the job; may be repeated")
      ->type_name("TAG")
      ->allow_extra_args(false);
}

void AddFarmCommands(CLI::App& app, Options& options) {
  CLI::App& submit = AddCommand(app, options, "submit", "hand a scene to a farm; prints the job's number");
  AddScene(submit, options);
  AddCoordinator(submit, options);
  submit.add_option("--name", options.name, "what the job is called [default: the scene's file name]");
  AddInteger(submit, "--priority", "higher goes first [default: 0]", -kPriorityMax, kPriorityMax,
             options.priority);
  AddRequire(submit, options);
  AddVerify(submit, options);
  submit.add_flag("--watch", options.watch, "follow the job until it ends");
  AddRenderOptions(submit, options);

  AddCoordinator(AddCommand(app, options, "jobs", "list the jobs of a farm"), options);
  AddCoordinator(AddCommand(app, options, "workers", "list the workers of a farm"), options);
  const std::pair<const char*, const char*> worker_commands[] = {
      {"drain", "give workers nothing new; they finish what they hold"},
      {"release", "let workers work again after a drain or a quarantine"}};
  for (const auto& [name, help] : worker_commands) {
    CLI::App& command = AddCommand(app, options, name, help);
    command
        .add_option("WORKER", options.worker, "name of workers, or the number of one as workers lists them")
        ->required();
    AddCoordinator(command, options);
  }
  const std::pair<const char*, const char*> job_commands[] = {
      {"status", "say how far a job is"},
      {"watch", "follow a job until it ends"},
      {"cancel", "stop a job"},
      {"extend", "give a job more samples"},
      {"pause", "render no more of a job for now"},
      {"resume", "go on with a job that was paused"},
      {"priority", "let a job go before others"},
      {"fetch", "get the picture of a job, or those of a sequence"}};
  for (const auto& [name, help] : job_commands) {
    CLI::App& command = AddCommand(app, options, name, help);
    AddJob(command, options);
    if (std::string_view(name) == "priority") AddPriority(command, options);
    AddCoordinator(command, options);
    if (std::string_view(name) == "extend") AddSamples(command, options.render)->required();
    if (std::string_view(name) != "fetch") continue;
    AddOutput(command, options, "job-JOB.exr");
    AddWord(command, "--frame", "only this one of a sequence [default: all]", "N",
            [&options](const std::string& word) {
              options.frame = static_cast<int>(Take(ParseInteger("--frame", word, 0, kFrameNumberMax)));
            });
    command.add_flag("--preview", options.preview, "take what is there of an unfinished picture");
  }
}

std::vector<std::string> KnownWords(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    for (const std::string& name : option->get_snames()) words.push_back("-" + name);
  }
  return words;
}

// The complaint about the first word that no command takes, if there is one.
std::string UnknownWord(const CLI::App& app) {
  std::vector<std::string> known;
  std::string what, word;
  for (const CLI::App* command : app.get_subcommands()) {
    if (command->remaining().empty()) continue;
    word = command->remaining().front();
    known = KnownWords(*command);
    what = word.starts_with("-") ? command->get_name() + ": unknown flag"
                                 : command->get_name() + ": unexpected word";
  }
  if (word.empty() && !app.remaining().empty()) {
    word = app.remaining().front();
    for (const CLI::App* command : app.get_subcommands(nullptr)) known.push_back(command->get_name());
    if (word.starts_with("-")) known = KnownWords(app);
    what = word.starts_with("-") ? "unknown flag" : "unknown command";
  }
  if (word.empty()) return {};
  const std::string stem = word.substr(0, word.find('='));
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  return fmt::format("{} \"{}\"{}", what, stem, DidYouMean(stem, candidates));
}

std::string DefaultCoordinator() {
  const char* set = std::getenv("TESSERA_COORDINATOR");
  return set != nullptr && *set != '\0' ? set : kCoordinatorAddressDefault;
}

Result<CommandLine> Parse(CLI::App& app, Options& options, std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // CLI11 takes them from the back
  std::string problem;
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    const auto chosen = app.get_subcommands();
    return CommandLine{options, chosen.empty() ? app.help() : chosen.front()->help()};
  } catch (const CLI::CallForVersion&) {
    return CommandLine{options, fmt::format("tessera {}\n", kSoftwareVersion)};
  } catch (const CLI::ParseError& e) {
    problem = e.what();
  }
  if (const std::string unknown = UnknownWord(app); !unknown.empty()) problem = unknown;
  if (!problem.empty()) return BadInput(problem);
  if (options.command.empty()) return BadInput("no command; tessera --help lists them");
  if (options.coordinator.empty()) options.coordinator = DefaultCoordinator();
  return CommandLine{options, {}};
}

}  // namespace

Result<CommandLine> ParseCommandLine(const std::vector<std::string>& arguments) {
  CLI::App app("Tessera renders scenes on one machine or on a farm of them.", "tessera");
  Options options;
  app.allow_extras();
  app.set_version_flag("--version", std::string(kSoftwareVersion));
  AddLocalCommands(app, options);
  AddFarmCommands(app, options);
  return Parse(app, options, arguments);
}

}  // namespace tessera
