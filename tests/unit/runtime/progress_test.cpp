#include "runtime/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

Scenario with_sites(int sites) {
  Scenario scenario;
  scenario.time.step_s = 0.001;
  scenario.time.duration_s = 31.0;
  scenario.time.last_step = 31000;
  for (int i = 1; i <= sites; ++i) scenario.substructures.emplace_back().id = "site_" + std::to_string(i);
  return scenario;
}

Event resent(const std::string& subject) {
  Event event;
  event.source = kCoordinatorId;
  event.severity = Severity::warning;
  event.code = EventCode::command_repeated;
  event.subject = subject;
  return event;
}

class ProgressTest : public ::testing::Test {
 protected:
  void make(int sites) {
    scenario_ = with_sites(sites);
    progress_ = std::make_unique<Progress>(scenario_, out_.get());
  }
  void all_run(double displacement_m) {
    ParticipantStatus status;
    status.state = LifecycleState::running;
    status.role = Role::coordinator;
    status.id = kCoordinatorId;
    progress_->learn(status);
    status.role = Role::experimental_site;
    for (std::size_t i = 0; i < scenario_.substructures.size(); ++i) {
      status.id = scenario_.substructures[i].id;
      progress_->learn(status);
      SignalBlock block;
      block.participant = status.id;
      block.group = FixedText<32>{"control"};
      block.model_time_s = {0.0};
      const auto add = [&](const char* name, double value) {
        block.signals.push_back(
            {.name = name, .subject = "", .unit = "", .least = {value}, .most = {value}, .last = {value}});
      };
      add("measured_displacement", displacement_m);
      add("force", -3400.0);
      progress_->learn(block);
    }
  }
  void end() { progress_.reset(); }
  [[nodiscard]] std::string printed() {
    std::string text(static_cast<std::size_t>(std::ftell(out_.get())), '\0');
    std::rewind(out_.get());
    text.resize(std::fread(text.data(), 1, text.size(), out_.get()));
    return text;
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> out_{std::tmpfile()};
  Scenario scenario_;
  std::unique_ptr<Progress> progress_;
};

TEST_F(ProgressTest, FitsEveryWidthWith32Sites) {
  make(32);
  progress_->set_completed(1, Instant{} + std::chrono::seconds{1});
  progress_->set_completed(502, Instant{} + std::chrono::seconds{2});
  all_run(0.0012);
  for (std::size_t width = 20; width < 300; ++width) EXPECT_LE(progress_->line(width).size(), width);
  const std::string line = progress_->line(120);
  EXPECT_THAT(line, AllOf(HasSubstr("step 502/31000"), HasSubstr("steps/s"), HasSubstr("all 33 running"),
                          HasSubstr("site_1 +1.2 mm -3.4 kN"), EndsWith(" sites"), Not(HasSubstr("site_32"))));
}

TEST_F(ProgressTest, ShowsSignalsOfAllSitesWhereTheyFit) {
  make(2);
  all_run(0.0012);
  EXPECT_EQ(progress_->line(120),
            "step 0/31000  0.00 of 31.00 s  all 3 running  site_1 +1.2 mm -3.4 kN  site_2 +1.2 mm -3.4 kN");
}

TEST_F(ProgressTest, NamesWhoIsMissing) {
  make(5);
  ParticipantStatus status;
  status.state = LifecycleState::ready;
  status.role = Role::coordinator;
  status.id = kCoordinatorId;
  progress_->learn(status);
  EXPECT_THAT(progress_->line(120), HasSubstr("not found yet: site_1, site_2 +3; ready: coordinator"));
}

TEST_F(ProgressTest, ShowsTheStatesOfThoseWhoAreHeardAlone) {
  scenario_ = with_sites(5);
  progress_ = std::make_unique<Progress>(scenario_, out_.get(), std::vector<std::string>{"coordinator", "site_4"});
  all_run(0.0);
  EXPECT_THAT(progress_->line(120), HasSubstr("all 2 running"));
}

TEST_F(ProgressTest, WritesHugeNumbersShort) {
  make(1);
  all_run(1e300);
  EXPECT_THAT(progress_->line(200), HasSubstr("site_1 +1.00e+303 mm -3.4 kN"));
}

TEST_F(ProgressTest, CountsRepeatedEventsInsteadOfPrintingThem) {
  make(1);
  for (int i = 0; i < 500; ++i) {
    progress_->show(Instant{} + std::chrono::milliseconds{i});
    progress_->print(resent("site_1"));
    if (i == 7) progress_->print(resent("site_2"));
  }
  end();
  const std::string text = printed();
  EXPECT_THAT(text, AllOf(HasSubstr("resent the command to 'site_1', which has not answered\n"),
                          HasSubstr("resent the command to 'site_1', which has not answered (497 times more)\n"),
                          HasSubstr("'site_2', which has not answered\n"),
                          Not(HasSubstr("'site_2', which has not answered ("))));
  EXPECT_EQ(std::ranges::count(text, '\n'), 6) << text;  // with one of show()
}

TEST_F(ProgressTest, SaysFromTimeToTimeHowOftenAnEventHasCome) {
  make(1);
  for (int second = 0; second < 25; ++second) {
    progress_->show(Instant{} + std::chrono::seconds{second});
    progress_->print(resent("site_1"));
  }
  const std::string text = printed();
  EXPECT_THAT(text, AllOf(HasSubstr("(7 times more)"), HasSubstr("(10 times more)")));
}

}  // namespace
}  // namespace hybridtest
