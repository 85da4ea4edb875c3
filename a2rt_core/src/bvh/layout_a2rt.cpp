#include "a2rt/bvh/layout_a2rt.h"

#include <limits>

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {
namespace {

constexpr std::uint32_t kGroupBit = 0x80, kLeafField = 0x7f;

bool one_scale(const arith::A2rtPrecision& precision) {
  return precision.scales == arith::ScaleSharing::kSingle;
}

// Writes the records breadth first. Children are given the next free bytes when their parent is
// written, and are written in the same order, so no table of offsets is needed. (The order of the
// tree's records is not it: classification moved siblings, not their children.)
class Encoder {
 public:
  Encoder(const WideBvh& bvh, const Classification& classes, const arith::A2rtPrecision& precision,
          std::uint32_t alignment, const std::string& what, A2rtRecordSink* sink)
      : bvh_(bvh),
        classes_(classes),
        precision_(precision),
        alignment_(alignment),
        what_(what),
        sink_(sink),
        group_bytes_(a2rt_group_bytes(precision)),
        sub_bytes_(a2rt_sub_bytes(precision)),
        next_(group_bytes_) {}

  std::vector<std::byte> run() {
    std::vector<std::byte> bytes;
    frames_.reserve(classes_.group_nodes);
    frame_.resize(bvh_.records.size());
    parents_.reserve(classes_.inner_nodes);
    const std::uint64_t packed =
        classes_.group_nodes * group_bytes_ + classes_.sub_nodes * sub_bytes_;
    ByteWriter out(bytes, packed);
    write(0, out);
    for (std::size_t p = 0; p < parents_.size(); ++p) {
      const BvhRecord& parent = bvh_.records[parents_[p]];
      out.pad_to(aligned(out.size()));
      if (sink_ != nullptr) {
        sink_->next_parent();
      }
      for (std::uint32_t c = parent.first; c < parent.first + parent.count; ++c) {
        write(c, out);
      }
    }
    out.finish();
    return bytes;
  }

 private:
  std::uint64_t aligned(std::uint64_t at) const {
    return (at + alignment_ - 1) / alignment_ * alignment_;
  }
  bool is_group(std::uint32_t record) const { return classes_.is_group[record] != 0; }

  struct Range {
    std::uint32_t start, end;
  };

  // Where the record's children or primitives are; children get the next free bytes.
  Range place_children(const BvhRecord& r) {
    if (r.leaf()) {
      return {r.first, r.first + r.count};
    }
    const std::uint64_t start = aligned(next_);
    next_ = start;
    for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
      next_ += is_group(c) ? group_bytes_ : sub_bytes_;
    }
    if (next_ > std::numeric_limits<std::uint32_t>::max()) {
      throw UserError(what_ + ": its nodes exceed the 4 GiB that A2RT's addresses reach");
    }
    return {static_cast<std::uint32_t>(start), static_cast<std::uint32_t>(next_)};
  }

  void write(std::uint32_t i, ByteWriter& out) {
    const BvhRecord& r = bvh_.records[i];
    const auto offset = static_cast<std::uint32_t>(out.size());
    const Range range = place_children(r);
    if (!r.leaf()) {
      parents_.push_back(i);
    }
    out.u8((is_group(i) ? kGroupBit : 0U) | (r.leaf() ? kLeafField : 0U));
    if (is_group(i)) {
      write_group(i, out);
    } else {
      write_sub(i, out);
    }
    out.u32(range.start);
    out.u32(range.end);
    if (sink_ == nullptr) {
      return;
    }
    if (is_group(i)) {
      sink_->group(i, offset, range.start, frames_.back());
    } else {
      sink_->sub(i, offset, range.start, last_box_);
    }
  }

  void write_group(std::uint32_t i, ByteWriter& out) {
    const Box& box = bvh_.records[i].box;
    frame_[i] = static_cast<std::uint32_t>(frames_.size());
    frames_.push_back(arith::make_group_frame(box, precision_, what_));
    out.box(box);
    if (one_scale(precision_)) {
      out.f32(frames_.back().scale.x);
    } else {
      out.vec3(frames_.back().scale);
    }
  }

  void write_sub(std::uint32_t i, ByteWriter& out) {
    const std::uint32_t group = classes_.group[i];
    last_box_ = arith::quantize_box(bvh_.records[i].box, bvh_.records[group].box,
                                    frames_[frame_[group]], precision_, what_);
    for (std::size_t a = 0; a < 6; ++a) {
      const std::uint32_t plane = a < 3 ? last_box_.lo[a] : last_box_.hi[a - 3];
      if (precision_.box_bits == 8) {
        out.u8(plane);
      } else {
        out.bits(plane, precision_.box_bits);
      }
    }
    out.align();
  }

  const WideBvh& bvh_;
  const Classification& classes_;
  const arith::A2rtPrecision& precision_;
  std::uint64_t alignment_;
  const std::string& what_;
  A2rtRecordSink* sink_;
  std::uint32_t group_bytes_, sub_bytes_;
  std::uint64_t next_;                     // first byte without an owner
  std::vector<arith::GroupFrame> frames_;  // of the groups, in record order
  std::vector<std::uint32_t> frame_;       // per record: index into frames_, groups only
  std::vector<std::uint32_t> parents_;     // inner records in the order written
  arith::QuantizedBox last_box_;
};

}  // namespace

std::uint32_t a2rt_group_bytes(const arith::A2rtPrecision& precision) {
  return 1 + 24 + (one_scale(precision) ? 4U : 12U) + 8;
}

std::uint32_t a2rt_sub_bytes(const arith::A2rtPrecision& precision) {
  return static_cast<std::uint32_t>((6 * precision.box_bits + 7) / 8 + 9);
}

std::vector<std::byte> encode_a2rt(const WideBvh& bvh, const Classification& classes,
                                   const arith::A2rtPrecision& precision, std::uint32_t alignment,
                                   const std::string& what, A2rtRecordSink* sink) {
  if (bvh.empty() || bvh.records[0].leaf()) {
    return {};
  }
  check_boxes(bvh, what);  // names the node; below, every box is known to be encodable
  return Encoder(bvh, classes, precision, alignment, what, sink).run();
}

A2rtRecord decode_a2rt(std::span<const std::byte> bytes, std::uint32_t offset,
                       const arith::A2rtPrecision& precision) {
  ByteReader in(bytes, offset);
  A2rtRecord r;
  const std::uint32_t id = in.u8();
  r.group = (id & kGroupBit) != 0;
  r.leaf = (id & kLeafField) == kLeafField;
  if (r.group) {
    r.box = in.box();
    if (one_scale(precision)) {
      const float scale = in.f32();
      r.scale = {scale, scale, scale};
    } else {
      r.scale = in.vec3();
    }
  } else {
    for (std::size_t a = 0; a < 6; ++a) {
      (a < 3 ? r.qbox.lo[a] : r.qbox.hi[a - 3]) =
          static_cast<std::uint16_t>(in.bits(precision.box_bits));
    }
    in.align();
  }
  r.start = in.u32();
  r.end = in.u32();
  return r;
}

}  // namespace a2rt::bvh
