#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/architecture/rules.hpp"
#include "tests/architecture/source_tree.hpp"

namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(IncludeDirection, TreeFollowsTheTableOfParts) {
  const std::vector<SourceFile> files = read_sources(HYBRIDTEST_SOURCE_DIR);
  for (const char* folder :
       {"core/", "mechanics/", "compensation/", "coordinator/", "numerical_substructure/", "experimental_site/",
        "transport/", "recording/", "diagnosis/runs/", "launch/", "tests/"}) {
    EXPECT_TRUE(std::ranges::any_of(files, [&](const SourceFile& file) { return file.path.starts_with(folder); }))
        << folder << " was not read";
  }
  EXPECT_THAT(violations(files), IsEmpty());
}

// Controls: each rule reports a violation.

struct ForbiddenLine {
  const char* path;
  const char* line;
  const char* finding;
};

class Forbidden : public testing::TestWithParam<ForbiddenLine> {};

TEST_P(Forbidden, IsReported) {
  const auto& [path, line, finding] = GetParam();
  EXPECT_THAT(violations({{path, std::string{"#include <vector>\n"} + line + "\n"}}), ElementsAre(finding));
}

INSTANTIATE_TEST_SUITE_P(
    Arrows, Forbidden,
    testing::Values(
        ForbiddenLine{"core/node.hpp", "#include \"mechanics/laws/law.hpp\"",
                      "core/node.hpp includes mechanics/laws/law.hpp: no arrow from core to it"},
        ForbiddenLine{"coordinator/coordinator.cpp", "#include \"experimental_site/site_link.hpp\"",
                      "coordinator/coordinator.cpp includes experimental_site/site_link.hpp: no arrow from "
                      "coordinator to it"},
        ForbiddenLine{"coordinator/coordinator.cpp", "#include \"runtime/executor.hpp\"",
                      "coordinator/coordinator.cpp includes runtime/executor.hpp: no arrow from coordinator to it"},
        ForbiddenLine{"diagnosis/replay.cpp", "#include \"experimental_site/site_link.hpp\"",
                      "diagnosis/replay.cpp includes experimental_site/site_link.hpp: no arrow from diagnosis to it"},
        ForbiddenLine{"launch/main.cpp", "#include \"tests/architecture/rules.hpp\"",
                      "launch/main.cpp includes tests/architecture/rules.hpp: no arrow from launch to it"},
        ForbiddenLine{"core/node.hpp", "#include \"./time.hpp\"",
                      "core/node.hpp includes ./time.hpp: includes are written from the root of the repository"},
        ForbiddenLine{"common/words.hpp", "", "common/words.hpp: a folder that the table of parts does not have"}));

INSTANTIATE_TEST_SUITE_P(
    Subfolders, Forbidden,
    testing::Values(
        ForbiddenLine{"diagnosis/verdict/verdict.cpp", "#include \"diagnosis/runs/diagnose_run.hpp\"",
                      "diagnosis/verdict/verdict.cpp includes diagnosis/runs/diagnose_run.hpp: no arrow from diagnosis "
                      "to it"},
        ForbiddenLine{"diagnosis/diagnose.cpp", "#include \"runtime/simulation.hpp\"",
                      "diagnosis/diagnose.cpp includes runtime/simulation.hpp: no arrow from diagnosis to it"},
        ForbiddenLine{"experimental_site/rigs/udp_rig.cpp", "#include \"plant/specimens/specimen.hpp\"",
                      "experimental_site/rigs/udp_rig.cpp includes plant/specimens/specimen.hpp: no arrow from "
                      "experimental_site to it"},
        ForbiddenLine{"experimental_site/control_loop.hpp", "#include \"experimental_site/rigs/simulated_rig.hpp\"",
                      "experimental_site/control_loop.hpp includes experimental_site/rigs/simulated_rig.hpp: no arrow "
                      "from experimental_site to it"},
        ForbiddenLine{"validation/blind_batches/plant/plant.cpp", "#include \"core/random.hpp\"",
                      "validation/blind_batches/plant/plant.cpp includes core/random.hpp: no arrow from "
                      "validation/blind_batches/plant to it"},
        ForbiddenLine{"validation/blind_batches/plant/plant.cpp",
                      "#include \"validation/blind_batches/make_batch.hpp\"",
                      "validation/blind_batches/plant/plant.cpp includes validation/blind_batches/make_batch.hpp: no "
                      "arrow from validation/blind_batches/plant to it"},
        ForbiddenLine{
            "report/plotting/page.cpp", "#include \"diagnosis/diagnose.hpp\"",
            "report/plotting/page.cpp includes diagnosis/diagnose.hpp: no arrow from report/plotting to it"}));

INSTANTIATE_TEST_SUITE_P(
    Libraries, Forbidden,
    testing::Values(
        ForbiddenLine{"runtime/participant.cpp", "#include <fastdds/dds/topic/Topic.hpp>",
                      "runtime/participant.cpp includes fastdds/dds/topic/Topic.hpp: a header of DDS, which "
                      "has no business here"},
        ForbiddenLine{"transport/in_process/hub.cpp", "#include \"hybridtestPubSubTypes.h\"",
                      "transport/in_process/hub.cpp includes hybridtestPubSubTypes.h: a header of DDS, "
                      "which has no business here"},
        ForbiddenLine{"scenario/scenario.cpp", "#include <yaml-cpp/yaml.h>",
                      "scenario/scenario.cpp includes yaml-cpp/yaml.h: a header of yaml-cpp, which has no "
                      "business here"},
        ForbiddenLine{"diagnosis/verdict/verdict.cpp", "#include <ceres/ceres.h>",
                      "diagnosis/verdict/verdict.cpp includes ceres/ceres.h: a header of Ceres, which has no business "
                      "here"},
        ForbiddenLine{"runtime/executor.cpp", "#include <boost/asio.hpp>",
                      "runtime/executor.cpp includes boost/asio.hpp: a header of a library that the table of libraries "
                      "does not have"},
        ForbiddenLine{"core/faults.cpp", "#  include <spdlog/spdlog.h>",
                      "core/faults.cpp includes spdlog/spdlog.h: a header of spdlog, which has no business "
                      "here"}));

INSTANTIATE_TEST_SUITE_P(
    TimeAndChance, Forbidden,
    testing::Values(ForbiddenLine{"coordinator/coordinator.cpp", "using Clock = std::chrono::steady_clock;",
                                  "coordinator/coordinator.cpp:2 names a clock of the machine: steady_clock"},
                    ForbiddenLine{"core/presence.cpp", "const auto t = ::time(nullptr);",
                                  "core/presence.cpp:2 names a clock of the machine: time(nullptr)"},
                    ForbiddenLine{"experimental_site/control_loop.cpp", "const Instant now = clock.now( );",
                                  "experimental_site/control_loop.cpp:2 calls now(): now( )"},
                    ForbiddenLine{"launch/progress.cpp", "std::this_thread::sleep_for(kPause);",
                                  "launch/progress.cpp:2 sleeps: sleep_for"},
                    ForbiddenLine{"tests/unit/core/presence_test.cpp", "::usleep(10);",
                                  "tests/unit/core/presence_test.cpp:2 sleeps: usleep"},
                    ForbiddenLine{"experimental_site/site_link.cpp", "arrived.wait_for(lock, kPatience);",
                                  "experimental_site/site_link.cpp:2 waits for a time: wait_for"},
                    ForbiddenLine{"plant/sensors/noisy_sensor.cpp", "std::normal_distribution<> noise;",
                                  "plant/sensors/noisy_sensor.cpp:2 draws from a generator that is not "
                                  "core/random.hpp: normal_distribution"}));

TEST(IncludeDirection, AllowedIncludesAreNotReported) {
  EXPECT_THAT(violations({
                  {"coordinator/main.cpp", "#include \"runtime/participant_process.hpp\"\n"},
                  {"experimental_site/rigs/simulated_rig.cpp", "#include \"mechanics/laws/law.hpp\"\n"},
                  {"diagnosis/runs/diagnose_run.cpp", "#include \"runtime/simulation.hpp\"\n"},
                  {"diagnosis/identification/fit_effects.cpp", "#include <ceres/ceres.h>\n"},
                  {"experimental_site/rigs/simulated_rig.cpp", "#include \"plant/site_model.hpp\"\n"},
                  {"runtime/executor.cpp", "#include <sys/mman.h>\n#include <vector>\n"},
                  {"transport/fast_dds/ports.cpp", "#include <fastdds/dds/topic/Topic.hpp>\n"},
                  {"core/config/yaml_reader.cpp", "#include <yaml-cpp/parser.h>\n"},
                  {"runtime/executor.cpp", "std::this_thread::sleep_until(t);\n"},
                  {"core/node.hpp",
                   "// steady_clock::now() would not do\n/* #include \"launch/x.hpp\" */\n"
                   "const char* text = \"now()\"; int n = 1'000; char c = '\"'; // sleep_for\n"},
              }),
              IsEmpty());
}

TEST(SourceTree, CodeAloneKeepsCodeAndLines) {
  EXPECT_EQ(code_alone("a // b\nc /* d\ne */ f \"g\\\"h\" 'i' 1'000 R\"x(j\")x\" k"),
            "a     \nc     \n     f            1'000           k");
}

}  // namespace
}  // namespace hybridtest::architecture
