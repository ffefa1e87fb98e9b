// Every call of every service is checked by its own rule before anything else happens.
#include "coordinator/access.h"

#include <gmock/gmock.h>

#include <mutex>
#include <set>

#include "tests/coordinator/generic_call.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

TEST(CallRules, EveryCallHasOneRuleAndEveryRuleACall) {
  std::multiset<std::string> methods, rules;
  for (const auto* method : AllMethods()) methods.insert(NameOf(*method));
  for (const CallRule& rule : kCallRules) rules.insert(std::string(rule.method));
  EXPECT_EQ(rules, methods);
}

// A coordinator whose policy refuses everything and notes what it was asked.
class ClosedServices : public Services {
 protected:
  ClosedServices()
      : Services([this](const Principal& caller, const CallRule& rule) -> Result<void> {
          const std::lock_guard lock(mutex_);
          asked_ = std::string(rule.method);
          peer_ = caller.peer;
          return BadInput("no entry");
        }) {}

  std::mutex mutex_;
  std::string asked_, peer_;
};

TEST_F(ClosedServices, EveryCallIsCheckedByItsOwnRuleBeforeItIsServed) {
  for (const auto* method : AllMethods()) {
    const grpc::Status status = MakeCall(*channel, *method, {""});
    EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << NameOf(*method);
    EXPECT_EQ(status.error_message(), "no entry") << NameOf(*method);
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(asked_, NameOf(*method));
    EXPECT_THAT(peer_, testing::StartsWith("unix:"));
  }
}

}  // namespace
}  // namespace tessera
