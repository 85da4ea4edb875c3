#include "a2rt/config/section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "a2rt/base/error.h"

namespace a2rt::config {
namespace {

using ::testing::ElementsAre;

// The message of the UserError that `action` throws; "no error" if it throws none.
std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

constexpr const char* kGood = R"(# a machine
name = "mobile"
clock = 1

[memory]
ports = 2
latency_ns = 12.5
kinds = ["read", "write"]
sizes = [1, 2.5]

[memory.bank]
open = true
)";

class Folder {
 public:
  Folder() : path_(std::filesystem::path(::testing::TempDir()) / unique()) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  static std::string unique() {
    return std::string("a2rt_config_") +
           ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  std::filesystem::path path_;
};

TEST(Section, ReadsEveryTypeAndDescribesWhatWasRead) {
  const auto top = Section::from_text(kGood, "gpu.toml");
  EXPECT_EQ(top.text("name", "name of the machine"), "mobile");
  EXPECT_EQ(top.number("clock", 0.5, 0.1, 5, "GHz", "core clock"), 1.0);
  const auto memory = top.table("memory");
  EXPECT_EQ(memory.integer("ports", 1, 1, 8, "ports", "of the cache"), 2);
  EXPECT_EQ(memory.number("latency_ns", 0.0, 1e9, "ns", "of a hit"), 12.5);
  EXPECT_THAT(memory.texts("kinds", "accesses"), ElementsAre("read", "write"));
  EXPECT_THAT(memory.numbers("sizes", "MiB", "of the levels"), ElementsAre(1.0, 2.5));
  EXPECT_TRUE(memory.table("bank").boolean("open", false, "open-page policy"));
  EXPECT_EQ(memory.integer("ways", 4, 1, 8, "ways", "associativity"), 4);
  top.reject_unknown_keys();

  std::vector<std::string> lines;
  for (const auto& doc : top.describe()) {
    lines.push_back(doc.key + "=" + doc.value + " " + doc.unit);
  }
  EXPECT_THAT(lines, ElementsAre("name=\"mobile\" ", "clock=1 GHz", "memory.ports=2 ports",
                                 "memory.latency_ns=12.5 ns", "memory.kinds=[\"read\", \"write\"] ",
                                 "memory.sizes=[1, 2.5] MiB", "memory.bank.open=true ",
                                 "memory.ways=4 ways"));
}

TEST(Section, AbsentTableGivesDefaults) {
  const auto top = Section::from_text("", "empty.toml");
  EXPECT_EQ(top.table("memory").integer("ports", 3, 1, 8, "ports", "of the cache"), 3);
  EXPECT_FALSE(top.has("memory"));
  top.reject_unknown_keys();
}

TEST(Section, KeysAreListedInTheOrderOfTheFile) {
  const auto top = Section::from_text("z = 1\na = 2\n[m]\nq = 1\nb = 2\n", "order.toml");
  EXPECT_THAT(top.keys(), ElementsAre("z", "a", "m"));
  EXPECT_THAT(top.table("m").keys(), ElementsAre("q", "b"));
  EXPECT_EQ(top.where("a"), "order.toml:2:1");
}

TEST(Section, ArraysOfTablesAreRead) {
  const auto top = Section::from_text("[[scene]]\nname = 'a'\n[[scene]]\nname = 'b'\n", "s.toml");
  const auto scenes = top.tables("scene");
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[1].text("name", "of the scene"), "b");
  EXPECT_EQ(error_of([&] { top.reject_unknown_keys(); }),
            "s.toml:2:1: unknown key 'scene[0].name'; nothing is configured here");
}

struct BadCase {
  const char* name;
  const char* text;
  std::function<void(const Section&)> use;
  const char* message;
};

class BadFile : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadFile, SaysPlaceReasonAndRemedy) {
  EXPECT_EQ(error_of([] {
              const auto& bad = GetParam();
              const auto top = Section::from_text(bad.text, "x.toml");
              bad.use(top);
              top.reject_unknown_keys();
            }),
            GetParam().message);
}

const BadCase kBadCases[] = {
    {"UnknownKey", "warps = 4\n",
     [](const Section& s) { s.integer("warp", 1, 1, 8, "warps", "resident"); },
     "x.toml:1:1: unknown key 'warps'; did you mean 'warp'?"},
    {"UnknownKeyFarFromAll", "a = 4\nelephants = 4\n",
     [](const Section& s) { s.integer("a", 1, 1, 8, "", "first"); },
     "x.toml:2:1: unknown key 'elephants'; known here: a"},
    {"UnknownTable", "\n[cache]\nways = 4\n", [](const Section&) {},
     "x.toml:2:2: unknown key 'cache'; nothing is configured here"},
    {"UnknownKeyInSubTable", "[l1]\nways = 4\nwaves = 4\n",
     [](const Section& s) { s.table("l1").integer("ways", 1, 1, 8, "ways", "of L1"); },
     "x.toml:3:1: unknown key 'l1.waves'; did you mean 'ways'?"},
    {"WrongType", "[l1]\n  ways = 'four'\n",
     [](const Section& s) { s.table("l1").integer("ways", 1, 1, 8, "ways", "of L1"); },
     "x.toml:2:3: l1.ways is a string, must be an integer from 1 to 8 ways (of L1)"},
    {"FractionForInteger", "n = 1.0\n",
     [](const Section& s) { s.integer("n", 1, 1, 8, "", "count"); },
     "x.toml:1:1: n is a number, must be an integer from 1 to 8 (count)"},
    {"BelowRange", "n = 0\n", [](const Section& s) { s.integer("n", 1, 1, 8, "lanes", "width"); },
     "x.toml:1:1: n is 0, must be an integer from 1 to 8 lanes (width)"},
    {"NanIsOutsideEveryRange", "f = nan\n",
     [](const Section& s) { s.number("f", 1, 0, INFINITY, "GHz", "clock"); },
     "x.toml:1:1: f is nan, must be a number from 0 to inf GHz (clock)"},
    {"NotAChoice", "u = 'aqb9'\n",
     [](const Section& s) { s.choice("u", "a2rt", {"aqb8", "a2rt"}, "RT unit"); },
     "x.toml:1:1: u is \"aqb9\", must be one of aqb8, a2rt (RT unit)"},
    {"Missing", "", [](const Section& s) { s.text("scene", "glTF file"); },
     "x.toml: scene is missing, must be a string (glTF file)"},
    {"ValueForTable", "l1 = 3\n", [](const Section& s) { s.table("l1"); },
     "x.toml:1:1: l1 is an integer, must be a table: [l1]"},
    {"MixedArray", "v = [1, 'a']\n", [](const Section& s) { s.numbers("v", {}, "", "values"); },
     "x.toml:1:1: v is an array of mixed or nested values, must be an array of numbers (values)"},
    {"Date", "v = 2020-01-01\n", [](const Section& s) { s.text("v", "", "value"); },
     "x.toml:1:1: v is a date or time, must be a string (value)"},
};
INSTANTIATE_TEST_SUITE_P(Section, BadFile, ::testing::ValuesIn(kBadCases),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(Section, SyntaxErrorsNameLineAndColumn) {
  EXPECT_THAT(error_of([] { Section::from_text("a = 1\nb = = 2\n", "x.toml"); }),
              ::testing::StartsWith("x.toml:2:5: "));
  EXPECT_THAT(error_of([] { Section::from_text("a = 1\na = 2\n", "x.toml"); }),
              ::testing::StartsWith("x.toml:2:"));
}

TEST(Section, OverridesWinAndBareWordsAreStrings) {
  const auto top =
      Section::from_text(kGood, "gpu.toml", {"memory.ports=4", "name=table1", "clock = 2.5"});
  EXPECT_EQ(top.table("memory").integer("ports", 1, 1, 8, "ports", "of the cache"), 4);
  EXPECT_EQ(top.text("name", "of the machine"), "table1");
  EXPECT_EQ(top.number("clock", 0, 9, "GHz", "core clock"), 2.5);
  EXPECT_TRUE(top.table("memory").table("bank").boolean("open", false, "open-page policy"));
}

TEST(Section, BadOverridesNameThemselves) {
  EXPECT_EQ(error_of([] { Section::from_text("", "x.toml", {"ports"}); }),
            "override 'ports' must have the form key=value");
  EXPECT_EQ(error_of([] { Section::from_text("", "x.toml", {"a=1", "a=2"}); }),
            "override 'a=2':1:1: a is already set by override 'a=1':1:1; give it once");
  EXPECT_THAT(error_of([] { Section::from_text("", "x.toml", {"a=[1,"}); }),
              ::testing::StartsWith("override 'a=[1,':1:"));
  EXPECT_EQ(error_of([] { Section::from_text("", "x.toml", {"typo=1"}).reject_unknown_keys(); }),
            "override 'typo=1':1:1: unknown key 'typo'; nothing is configured here");
}

TEST(Section, InheritedValuesHoldWhereTheFileIsSilent) {
  const Folder folder;
  std::filesystem::create_directories(folder.file("x", "").parent_path() / "base");
  folder.file("base/gpu.toml", "sms = 30\n[l1]\nways = 4\nlines = 64\n[l2]\nways = 16\n");
  const auto file = folder.file("mine.toml", "inherits = 'base/gpu.toml'\n[l1]\nways = 8\n");
  const auto top = Section::from_file(file, {"l1.lines=32"});
  EXPECT_EQ(top.integer("sms", 1, 99, "", "SMs"), 30);
  EXPECT_EQ(top.table("l1").integer("ways", 1, 99, "", "of L1"), 8);
  EXPECT_EQ(top.table("l1").integer("lines", 1, 99, "", "of L1"), 32);
  EXPECT_EQ(error_of([&] { top.reject_unknown_keys(); }),
            (file.parent_path() / "base/gpu.toml").string() +
                ":5:2: unknown key 'l2'; did you mean 'l1'?");
}

TEST(Section, AnEmptyFileHasOnlyDefaults) {
  const Folder folder;
  const auto top = Section::from_file(folder.file("empty.toml", ""));
  EXPECT_EQ(top.integer("warps", 4, 1, 99, "warps", "Resident warps"), 4);
  EXPECT_NO_THROW(top.reject_unknown_keys());
}

TEST(Section, InheritanceCyclesAndMissingFilesAreRefused) {
  const Folder folder;
  const auto a = folder.file("a.toml", "inherits = 'b.toml'\n");
  const auto b = folder.file("b.toml", "x = 1\ninherits = 'a.toml'\n");
  EXPECT_EQ(error_of([&] { Section::from_file(a); }),
            b.string() + ":2:1: '" + a.string() +
                "' inherits from itself through this line; remove one `inherits`");
  const auto c = folder.file("c.toml", "inherits = 'none.toml'\n");
  EXPECT_EQ(error_of([&] { Section::from_file(c); }),
            c.string() + ":1:1: cannot read the configuration file '" +
                (c.parent_path() / "none.toml").string() + "'; check the path");
  const auto d = folder.file("d.toml", "inherits = 4\n");
  EXPECT_EQ(error_of([&] { Section::from_file(d); }),
            d.string() +
                ":1:1: inherits is an integer, must be a string: the file to start from, "
                "relative to this one");
  EXPECT_EQ(
      error_of([&] { Section::from_file(a.parent_path()); }),
      "cannot read the configuration file '" + a.parent_path().string() + "'; check the path");
}

}  // namespace
}  // namespace a2rt::config
