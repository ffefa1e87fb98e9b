// What `tessera doctor` finds out.
#pragma once

#include <string>
#include <vector>

namespace tessera {

enum class Severity { kGood, kWarning, kProblem };

struct Finding {
  Severity severity{};
  std::string where;   // what was examined: "login "studio" (10.0.0.5:7700)"
  std::string what;    // what was found
  std::string remedy;  // what to do about it; empty if nothing
};

using Findings = std::vector<Finding>;

// "1 worker", "2 workers".
inline std::string Counted(size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

inline void Append(Findings& findings, Findings more) {
  for (Finding& each : more) findings.push_back(std::move(each));
}

}  // namespace tessera
