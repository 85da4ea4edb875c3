// The loader refuses what would make a comparison wrong; the shipped table holds its anchors.
#include "a2rt/energy/table.h"

#include <gtest/gtest.h>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

const std::string kHeader =
    "component,action,width,node_nm,vdd,clock_ns,energy_pj,energy_low_pj,energy_high_pj,area_um2,"
    "leak_uw,source,note\n";
const std::string kBox = "box,test,192,12,0.8,1,8,5,12,7000,400,\"a paper, a table\",published\n";

EnergyTable table(const std::string& text) { return EnergyTable::from_text(text, "t.csv"); }

// The message of the error that `text` causes; empty if there is none.
std::string error_of(const std::string& text) {
  try {
    table(text);
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

TEST(EnergyTable, reads_rows_comments_and_quoted_commas) {
  const EnergyTable t = table("# a comment\n" + kHeader + kBox);
  ASSERT_EQ(t.rows().size(), 1u);
  EXPECT_EQ(t.find("box", "test").source, "a paper, a table");
  EXPECT_EQ(t.find("box", "test").note, Note::kPublished);
  EXPECT_DOUBLE_EQ(t.area_um2("box"), 7000);
  EXPECT_THROW(t.find("box", "jump"), UserError);
}

TEST(EnergyTable, an_unknown_column_is_refused_with_its_line) {
  EXPECT_NE(error_of("colour," + kHeader + "red," + kBox).find("t.csv:1: unknown column 'colour'"),
            std::string::npos);
}

TEST(EnergyTable, a_missing_column_is_refused) {
  EXPECT_NE(error_of("component,action\nbox,test\n").find("is missing"), std::string::npos);
}

TEST(EnergyTable, a_row_without_source_is_refused) {
  EXPECT_NE(
      error_of(kHeader + "box,test,192,12,0.8,1,8,5,12,7000,400,,published\n").find("'source'"),
      std::string::npos);
}

TEST(EnergyTable, two_nodes_in_one_table_are_refused) {
  EXPECT_NE(error_of(kHeader + kBox + "l1,read,256,45,0.9,1,50,40,60,0,0,x,estimated\n")
                .find("one table holds one node"),
            std::string::npos);
}

TEST(EnergyTable, a_free_action_is_refused) {
  EXPECT_NE(error_of(kHeader + "box,test,192,12,0.8,1,0,0,0,0,0,x,estimated\n").find("free"),
            std::string::npos);
}

TEST(EnergyTable, an_energy_outside_its_band_is_refused) {
  EXPECT_NE(error_of(kHeader + "box,test,192,12,0.8,1,8,9,12,0,0,x,estimated\n").find("band"),
            std::string::npos);
}

TEST(EnergyTable, a_note_that_is_none_of_the_three_is_refused) {
  EXPECT_NE(error_of(kHeader + "box,test,192,12,0.8,1,8,5,12,0,0,x,guessed\n").find("guessed"),
            std::string::npos);
}

TEST(EnergyTable, a_second_row_for_one_action_is_refused) {
  EXPECT_NE(error_of(kHeader + kBox + kBox).find("twice"), std::string::npos);
}

TEST(EnergyTable, leakage_on_a_second_row_of_a_component_is_refused) {
  EXPECT_NE(error_of(kHeader + kBox + "box,set,192,12,0.8,1,8,5,12,0,3,x,estimated\n")
                .find("first row only"),
            std::string::npos);
}

TEST(EnergyTable, a_word_in_place_of_a_number_is_refused) {
  EXPECT_NE(error_of(kHeader + "box,test,192,12,0.8,1,much,5,12,0,0,x,estimated\n").find("'much'"),
            std::string::npos);
}

TEST(Table12nm, quantized_testers_add_up_to_the_papers_table_2) {
  const EnergyTable t = EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  for (const auto& [name, mw, um2] :
       {std::tuple{"qbox_a2rt", 1.89, 973.53}, std::tuple{"qbox_aqb8", 3.31, 1668.72}}) {
    const Row& row = t.find(name, "test");
    EXPECT_NEAR(row.energy_pj / row.clock_ns + row.leak_uw * 1e-3, mw, 1e-3) << name;
    EXPECT_DOUBLE_EQ(row.area_um2, um2);
    EXPECT_EQ(row.note, Note::kPublished);
  }
}

TEST(Table12nm, the_engine_of_table_2_adds_up_to_its_area_and_power) {
  const EnergyTable t = EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  double um2 = 0, mw = 0;
  for (const auto& [name, action, count] :
       {std::tuple{"qbox_a2rt", "test", 120}, std::tuple{"box", "test", 15},
        std::tuple{"quantizer", "quantize", 15}, std::tuple{"triangle", "test", 24}}) {
    const Row& row = t.find(name, action);
    um2 += count * row.area_um2;
    mw += count * (row.energy_pj / row.clock_ns + row.leak_uw * 1e-3);
  }
  EXPECT_NEAR(um2 * 1e-6, 1.26, 0.001);
  EXPECT_NEAR(mw * 1e-3, 1.48, 0.002);
}

}  // namespace
}  // namespace a2rt::energy
