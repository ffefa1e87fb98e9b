#include "tests/simulation/scale_farm.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double kTimeLimit = 3;         // times the ideal: then the farm has failed
constexpr double kCostSpread = 8;        // the most expensive tile over the cheapest
constexpr double kDurationSpread = 0.1;  // of a unit's time, either way

double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

ScaleOptions ScaleOptionsFor(int workers, double ideal_s) {
  ScaleOptions options;
  options.workers = workers;
  options.ideal_s = ideal_s;
  // A render of a quarter hour on one machine is a small picture, that of 10,000 machines a cinema's.
  if (workers <= 10) {
    options.width = 1280;
    options.height = 720;
    options.samples_per_pixel = 256;
  } else if (workers >= 1000) {
    options.samples_per_pixel = 4096;
  }
  if (workers >= 10'000) {
    options.width = 3840;
    options.height = 2160;
  }
  return options;
}

ScaleFarm::ScaleFarm(ScaleOptions options)
    : options_(options), random_(Hash(options.seed, 3)), farm_(SchedulerOptions{}) {
  farm_.Begin({});
  machines_.resize(static_cast<size_t>(options_.workers));
  const auto slow = static_cast<size_t>(std::lround(options_.slow_share * options_.workers));
  for (size_t m = 0; m < machines_.size(); ++m) {
    // Spread evenly, so that every farm has its share of slow machines.
    const bool is_slow =
        slow > 0 && m % (machines_.size() / slow) == 0 && m / (machines_.size() / slow) < slow;
    machines_[m].speed = (is_slow ? options_.slow_speed : 1) * random_.Real(0.8, 1.25);
    total_speed_ += machines_[m].speed;
  }
  Submit();
}

// The picture is simulated at an eighth of its width and height, so that merging costs nothing here; tiles,
// units and costs are those of the whole.
void ScaleFarm::Submit() {
  constexpr int kReduction = 8;
  auto spec = std::make_shared<JobSpec>();
  spec->submission = 1;
  FrameSpec frame;
  frame.width = options_.width / kReduction;
  frame.height = options_.height / kReduction;
  frame.crop = {0, 0, frame.width, frame.height};
  frame.tile_size = options_.tile_size / kReduction;
  frame.samples_per_pixel = options_.samples_per_pixel;
  frame.channels = ColorsAndWeight({"R"});
  spec->frames.push_back({"scene.pbrt", "", frame, 0});
  double cost = 0;
  for (int tile = 0; tile < frame.TileCount(); ++tile) {
    const auto area = static_cast<double>(frame.TileBounds(tile).area());
    tile_costs_.push_back(area * std::pow(kCostSpread, random_.Real(0, 1)));
    cost += tile_costs_.back() * frame.samples_per_pixel;
  }
  total_cost_ = options_.ideal_s * total_speed_;
  for (double& each : tile_costs_) each *= total_cost_ / cost;
  spec_ = spec;
  job_ = *farm_.Submit({}, spec);
}

double ScaleFarm::CostOf(const WorkUnit& unit) const {
  return tile_costs_[unit.tile] * unit.range.size;
}

void ScaleFarm::Post(Event event, double cost_s) {
  events_.push_back(std::move(event));
  events_cost_s_ += cost_s;
  ++report_.calls;
  PlanStep(std::max(busy_until_, queue_.now()));
}

void ScaleFarm::PlanStep(Instant at) {
  if (step_at_ <= at) return;
  step_at_ = at;
  queue_.After(at - queue_.now(), [this, plan = ++step_planned_] {
    if (plan == step_planned_) Step();
  });
}

void ScaleFarm::Step() {
  step_at_ = Instant::max();
  const Instant now = queue_.now();
  busy_until_ = now + FromSeconds(std::exchange(events_cost_s_, 0));
  const double before = ThreadSeconds();
  for (const Event& event : std::exchange(events_, {})) event(now);
  farm_.Advance(now);
  FarmOutput output = farm_.TakeOutput();
  const Instant patience = farm_.Patience(now);
  report_.core_cpu_s += ThreadSeconds() - before;
  const Instant delay = busy_until_ - now + FromSeconds(options_.latency_s);
  for (auto& answer : output.directives) {
    auto call = directive_calls_.extract(answer.call);
    report_.leases += answer.directive.leases.size();
    queue_.After(delay, [on_answer = std::move(call.mapped()), directive = std::move(answer.directive)] {
      on_answer(directive);
    });
  }
  for (auto& answer : output.results) {
    auto call = results_calls_.extract(answer.call);
    report_.leases += answer.grants.leases.size();
    report_.results += answer.verdicts.size();
    queue_.After(delay,
                 [on_answer = std::move(call.mapped()), results = std::move(answer)] { on_answer(results); });
  }
  if (!output.pictures.empty()) {
    report_.finished = true;
    report_.makespan_s = Seconds(now);
  }
  PlanStep(std::max(busy_until_, now + std::max(patience, Instant(1000))));
}

ScaleReport ScaleFarm::Run() {
  for (size_t m = 0; m < machines_.size(); ++m) Start(m);
  const Instant limit = FromSeconds(options_.ideal_s * kTimeLimit);
  while (!report_.finished && queue_.next_at() < limit) queue_.RunNext();
  // What still runs when the last sample is there was in vain.
  for (Machine& machine : machines_) {
    if (machine.running) copied_ += CostDone(*machine.running);
    if (!machine.worker) absent_ += Seconds(queue_.now() - machine.died) * machine.speed;
  }
  report_.ideal_s = options_.ideal_s;
  report_.lost_to_deaths = lost_ / total_cost_;
  report_.copied = copied_ / total_cost_;
  report_.absent = absent_ / (total_speed_ * Seconds(queue_.now()));
  return report_;
}

}  // namespace tessera
