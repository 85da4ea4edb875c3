#include "hdf5.h"

#include <algorithm>

#include "a2rt/base/error.h"

namespace a2rt::h5 {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

herr_t keep_innermost(unsigned, const H5E_error2_t* error, void* text) {
  if (error->desc != nullptr) {
    *static_cast<std::string*>(text) = error->desc;
  }
  return 0;
}

Handle scalar() { return {H5Screate(H5S_SCALAR), H5Sclose}; }

Handle text_type(std::size_t bytes) {
  Handle type{H5Tcopy(H5T_C_S1), H5Tclose};
  H5Tset_size(type.id(), std::max<std::size_t>(bytes, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

// HDF5 would clip a negative number that is read as an unsigned one.
bool same_number(hid_t a, hid_t b) {
  return H5Tget_class(a) == H5Tget_class(b) && H5Tget_size(a) == H5Tget_size(b) &&
         (H5Tget_class(a) != H5T_INTEGER || H5Tget_sign(a) == H5Tget_sign(b));
}

// Empty if a value of the file's type can be read as `memory`, member by member.
std::string incompatible(hid_t file, hid_t memory) {
  if (H5Tget_class(file) != H5Tget_class(memory)) {
    return "has another kind of element";
  }
  if (H5Tget_class(memory) != H5T_COMPOUND) {
    return same_number(file, memory) ? "" : "has elements of another size or sign";
  }
  const int members = H5Tget_nmembers(memory);
  for (unsigned i = 0; i < static_cast<unsigned>(members); ++i) {
    char* raw = H5Tget_member_name(memory, i);
    const std::string name = raw;
    H5free_memory(raw);
    const int found = H5Tget_member_index(file, name.c_str());
    if (found < 0) {
      return "lacks the field '" + name + "'";
    }
    const Handle wanted{H5Tget_member_type(memory, i), H5Tclose};
    const Handle stored{H5Tget_member_type(file, static_cast<unsigned>(found)), H5Tclose};
    if (!same_number(stored.id(), wanted.id())) {
      return "has a field '" + name + "' of another type";
    }
  }
  return "";
}

}  // namespace

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}
Quiet::~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

std::string last_error() {
  std::string text = "no reason given";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_innermost, &text);
  return text;
}

Handle compound(std::size_t bytes, const std::vector<Member>& members) {
  Handle type{H5Tcreate(H5T_COMPOUND, bytes), H5Tclose};
  for (const Member& m : members) {
    A2RT_CHECK(H5Tinsert(type.id(), m.name, m.offset, m.type) >= 0, "bad compound member");
  }
  return type;
}

Handle array_type(hid_t element, const std::vector<hsize_t>& dims) {
  return {H5Tarray_create2(element, static_cast<unsigned>(dims.size()), dims.data()), H5Tclose};
}

void Location::fail(const std::string& object, const std::string& what) const {
  throw UserError(place_ + (place_.ends_with('/') ? "" : "/") + object + ": " + what);
}

Location Location::create_group(const std::string& name) const {
  Handle group{H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
  if (!group.valid()) {
    fail(name, "cannot be written: " + last_error());
  }
  return {std::move(group), place_ + (place_.ends_with('/') ? "" : "/") + name};
}

Location Location::open_group(const std::string& name) const {
  Handle group{H5Gopen2(id(), name.c_str(), H5P_DEFAULT), H5Gclose};
  if (!group.valid()) {
    fail(name, "missing group; the file is no workload or is damaged");
  }
  return {std::move(group), place_ + (place_.ends_with('/') ? "" : "/") + name};
}

bool Location::has(const std::string& name) const {
  return H5Lexists(id(), name.c_str(), H5P_DEFAULT) > 0;
}

bool Location::has_attribute(const std::string& name) const {
  return H5Aexists(id(), name.c_str()) > 0;
}

void Location::write_attribute(const std::string& name, const std::string& text) const {
  const Handle type = text_type(text.size());
  const Handle space = scalar();
  const Handle attribute{
      H5Acreate2(id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  // An empty text still has one byte of storage: the terminator of c_str().
  if (!attribute.valid() || H5Awrite(attribute.id(), type.id(), text.c_str()) < 0) {
    fail("@" + name, "cannot be written: " + last_error());
  }
}

void Location::write_attribute(const std::string& name, std::uint32_t value) const {
  const Handle space = scalar();
  const Handle attribute{
      H5Acreate2(id(), name.c_str(), H5T_STD_U32LE, space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose};
  if (!attribute.valid() || H5Awrite(attribute.id(), H5T_NATIVE_UINT32, &value) < 0) {
    fail("@" + name, "cannot be written: " + last_error());
  }
}

std::string Location::text_attribute(const std::string& name) const {
  const Handle attribute{H5Aopen(id(), name.c_str(), H5P_DEFAULT), H5Aclose};
  if (!attribute.valid()) {
    fail("@" + name, "missing attribute");
  }
  const Handle type{H5Aget_type(attribute.id()), H5Tclose};
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0) {
    fail("@" + name, "must be a string of fixed length");
  }
  std::string text(H5Tget_size(type.id()), '\0');
  const Handle space{H5Aget_space(attribute.id()), H5Sclose};
  if (H5Sget_simple_extent_npoints(space.id()) != 1 ||
      H5Aread(attribute.id(), type.id(), text.data()) < 0) {
    fail("@" + name, "cannot be read: " + last_error());
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

std::uint32_t Location::integer_attribute(const std::string& name) const {
  const Handle attribute{H5Aopen(id(), name.c_str(), H5P_DEFAULT), H5Aclose};
  if (!attribute.valid()) {
    fail("@" + name, "missing attribute");
  }
  const Handle type{H5Aget_type(attribute.id()), H5Tclose};
  const Handle space{H5Aget_space(attribute.id()), H5Sclose};
  std::uint32_t value = 0;
  if (H5Tget_class(type.id()) != H5T_INTEGER || H5Sget_simple_extent_npoints(space.id()) != 1 ||
      H5Aread(attribute.id(), H5T_NATIVE_UINT32, &value) < 0) {
    fail("@" + name, "must be one integer");
  }
  return value;
}

void Location::write_rows(const std::string& name, hid_t type, const void* data, std::uint64_t rows,
                          std::size_t row_bytes, int deflate) const {
  const hsize_t dims[1] = {rows};
  const Handle space{H5Screate_simple(1, dims, nullptr), H5Sclose};
  const Handle plan{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  H5Pset_obj_track_times(plan.id(), false);  // the same workload gives the same bytes
  if (deflate > 0 && rows > 0) {
    const hsize_t chunk[1] = {std::clamp<hsize_t>(kChunkBytes / row_bytes, 1, rows)};
    H5Pset_chunk(plan.id(), 1, chunk);
    H5Pset_shuffle(plan.id());
    H5Pset_deflate(plan.id(), static_cast<unsigned>(deflate));
  }
  const Handle set{
      H5Dcreate2(id(), name.c_str(), type, space.id(), H5P_DEFAULT, plan.id(), H5P_DEFAULT),
      H5Dclose};
  if (!set.valid() ||
      (rows > 0 && H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)) {
    fail(name, "cannot be written: " + last_error());
  }
}

Handle Location::dataset(const std::string& name) const {
  Handle set{H5Dopen2(id(), name.c_str(), H5P_DEFAULT), H5Dclose};
  if (!set.valid()) {
    fail(name, "missing dataset; the file is no workload or is damaged");
  }
  return set;
}

std::uint64_t Location::rows(const std::string& name, hid_t type) const {
  const Handle set = dataset(name);
  const Handle stored{H5Dget_type(set.id()), H5Tclose};
  const std::string problem = incompatible(stored.id(), type);
  if (!problem.empty()) {
    fail(name, problem);
  }
  const Handle space{H5Dget_space(set.id()), H5Sclose};
  hsize_t dims[1] = {0};
  if (H5Sget_simple_extent_ndims(space.id()) != 1 ||
      H5Sget_simple_extent_dims(space.id(), dims, nullptr) != 1) {
    fail(name, "must have one dimension");
  }
  return dims[0];
}

void Location::read_rows(const std::string& name, hid_t type, void* data,
                         std::uint64_t expected) const {
  const Handle set = dataset(name);
  if (expected > 0 && H5Dread(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    fail(name, "cannot be read: " + last_error());
  }
}

Location create_file(const std::string& path, std::uint64_t user_block_bytes) {
  const Handle plan{H5Pcreate(H5P_FILE_CREATE), H5Pclose};
  H5Pset_userblock(plan.id(), user_block_bytes);
  Handle file{H5Fcreate(path.c_str(), H5F_ACC_TRUNC, plan.id(), H5P_DEFAULT), H5Fclose};
  if (!file.valid()) {
    throw UserError("cannot create '" + path + "': " + last_error() +
                    "; check that the folder exists and is writable");
  }
  return {std::move(file), path + ": /"};
}

Location open_file(const std::string& path) {
  Handle file{H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  if (!file.valid()) {
    throw UserError(path + ": not a readable HDF5 file: " + last_error() +
                    "; name a workload file, or capture it again");
  }
  return {std::move(file), path + ": /"};
}

}  // namespace a2rt::h5
