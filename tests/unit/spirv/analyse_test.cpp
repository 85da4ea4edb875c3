#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spirv/instrument.h"
#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using capture::Stage;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::module_named;

TEST(Analyse, FindsStagesAndWhatTheyDo) {
  const Analysis any = analyse(module_named("alpha.rahit.v12"));
  ASSERT_EQ(any.entry_points.size(), 1u);
  EXPECT_EQ(any.entry_points[0].stage, Stage::kAnyHit);
  EXPECT_TRUE(any.entry_points[0].ignores_intersection);
  EXPECT_TRUE(any.entry_points[0].terminates_ray);
  EXPECT_FALSE(any.entry_points[0].uses_ray_query);

  EXPECT_TRUE(analyse(module_named("sphere.rint.v12")).entry_points[0].reports_intersection);
  EXPECT_TRUE(analyse(module_named("tint.rcall.v12")).entry_points[0].executes_callable);
  EXPECT_TRUE(analyse(module_named("query.frag.v12")).entry_points[0].uses_ray_query);
  EXPECT_FALSE(analyse(module_named("plain.comp.v12")).has_rays());
}

TEST(Analyse, ReadsConstantFlagsMaskAndDescriptor) {
  const Analysis analysis = analyse(module_named("raygen.rgen.v12"));
  ASSERT_EQ(analysis.sites.size(), 1u);
  const TraceSite& site = analysis.sites[0];
  EXPECT_FALSE(site.is_query);
  EXPECT_EQ(site.ray_flags, 1u | 4u);
  EXPECT_EQ(site.cull_mask, 0xffu);
  EXPECT_EQ(site.structure.kind, StructureSource::Kind::kDescriptor);
  EXPECT_EQ(site.structure.set, 2u);
  EXPECT_EQ(site.structure.binding, 5u);
  EXPECT_FALSE(site.structure.is_array);
}

TEST(Analyse, FollowsVariablesAndDescriptorArrays) {
  const TraceSite site = analyse(module_named("plain_raygen.rgen.v12")).sites.at(0);
  EXPECT_EQ(site.ray_flags, 0x10u);
  EXPECT_EQ(site.cull_mask, 0x0fu);
  EXPECT_TRUE(site.structure.is_array);
  EXPECT_EQ(site.structure.element, 2u);
}

TEST(Analyse, FollowsParametersThroughEveryCall) {
  const TraceSite site = analyse(module_named("called_trace.rgen.v12")).sites.at(0);
  EXPECT_EQ(site.ray_flags, 4u | 8u);
  EXPECT_EQ(site.structure.kind, StructureSource::Kind::kDescriptor);
  EXPECT_EQ(site.structure.binding, 7u);
}

TEST(Analyse, SpecializationDecidesFlags) {
  const auto& words = module_named("query_sized.comp.v12");
  EXPECT_EQ(analyse(words).sites.at(0).ray_flags, 1u | 4u);
  const Specialization given[] = {{5, 8}};
  EXPECT_EQ(analyse(words, given).sites.at(0).ray_flags, 1u | 8u);
  // At module creation the values are not known yet.
  EXPECT_EQ(instrument(words, {}).analysis.sites.at(0).ray_flags, std::nullopt);
}

TEST(Analyse, KnowsTheWorkgroupSize) {
  using Size = std::array<std::uint32_t, 3>;
  EXPECT_EQ(analyse(module_named("query.comp.v12")).entry_points[0].local_size, (Size{8, 4, 1}));
  EXPECT_EQ(analyse(module_named("shared.asm")).entry_points[2].local_size, (Size{4, 2, 1}));
  EXPECT_EQ(analyse(module_named("raygen.rgen.v12")).entry_points[0].local_size, (Size{0, 0, 0}));
  for (const std::string variant : {"v12", "v13"}) {  // WorkgroupSize and LocalSizeId
    const auto& words = module_named("query_sized.comp." + variant);
    const Specialization given[] = {{0, 16}, {1, 2}};
    EXPECT_EQ(analyse(words, given).entry_points[0].local_size, (Size{16, 2, 1})) << variant;
    EXPECT_EQ(instrument(words, {}).analysis.entry_points[0].local_size[0], 0u) << variant;
  }
}

TEST(Analyse, ComputesFromSpecializationConstants) {
  using Size = std::array<std::uint32_t, 3>;
  const auto& words = module_named("computed.asm");
  const Analysis defaults = analyse(words);
  EXPECT_EQ(defaults.entry_points[0].local_size, (Size{8, 2, 1}));
  EXPECT_EQ(defaults.sites.at(0).ray_flags, 2u);
  EXPECT_EQ(defaults.sites.at(0).cull_mask, 0xfeu);
  const Specialization given[] = {{0, 9}, {1, 12}, {2, 0}};
  const Analysis special = analyse(words, given);
  EXPECT_EQ(special.entry_points[0].local_size, (Size{36, 3, 5}));
  EXPECT_EQ(special.sites.at(0).ray_flags, 1u);
  EXPECT_EQ(special.sites.at(0).cull_mask, 0xfau);
  // Division by zero is undefined: nothing is known then.
  const Specialization zero[] = {{1, 0}};
  EXPECT_EQ(analyse(words, zero).entry_points[0].local_size, (Size{0, 6, 0}));
}

TEST(Analyse, TellsWhichShadersChangeWhatOthersSee) {
  const auto writes = [](const std::string& name) {
    return analyse(module_named(name)).entry_points.at(0).writes_state;
  };
  EXPECT_TRUE(writes("alpha.rahit.v12"));  // its payload
  EXPECT_FALSE(writes("mask.rahit.v12"));
  EXPECT_FALSE(writes("sphere.rint.v12"));  // hit attributes only
  EXPECT_TRUE(writes("query_sized.comp.v12"));
}

TEST(Analyse, SaysThatAStructureComesFromAnAddress) {
  EXPECT_EQ(analyse(module_named("query_sized.comp.v12")).sites.at(0).structure.kind,
            StructureSource::Kind::kAddress);
}

TEST(Analyse, NamesEntryPointsAndTheirSitesInALinkedModule) {
  const Analysis analysis = analyse(module_named("linked.v12"));
  std::vector<std::string> names;
  for (const EntryPoint& entry : analysis.entry_points) {
    names.push_back(entry.name);
  }
  EXPECT_THAT(names, ElementsAre("gen", "hit", "miss", "any", "query"));
  EXPECT_THAT(analysis.entry_points[0].sites, ElementsAre(0u));
  EXPECT_THAT(analysis.entry_points[1].sites, ElementsAre(1u));
  EXPECT_THAT(analysis.entry_points[2].sites, ElementsAre());
  EXPECT_THAT(analysis.entry_points[4].sites, ElementsAre(2u));
}

TEST(Analyse, BothEntryPointsReachASharedSite) {
  const Analysis analysis = analyse(module_named("shared.asm"));
  ASSERT_EQ(analysis.entry_points.size(), 3u);
  EXPECT_THAT(analysis.entry_points[0].sites, ElementsAre(0u));
  EXPECT_THAT(analysis.entry_points[1].sites, ElementsAre(0u));
  EXPECT_THAT(analysis.entry_points[2].sites, ElementsAre());
}

TEST(Analyse, WarnsOfUnknownOpcodes) {
  auto words = module_named("twice.asm");
  words.insert(words.end() - 2, {2u << 16 | 0xfff0u, 1u});
  const Analysis analysis = analyse(words);
  ASSERT_EQ(analysis.warnings.size(), 1u);
  EXPECT_THAT(analysis.warnings[0], HasSubstr("opcode 65520"));
}

}  // namespace
}  // namespace a2rt::spirv
