// kQueryStep and kQueryVerdict records of ray queries.
#pragma once

#include "a2rt/capture/records.h"
#include "spirv/record_writer.h"

namespace a2rt::spirv {

// After OpRayQueryProceedKHR: what is committed so far.
void put_query_step(CodeBuilder& code, const RecordWriter& writer, const Instruction& proceed);
// Before Confirm, Generate or Terminate: the candidate and what the shader decides about it.
void put_query_verdict(CodeBuilder& code, const RecordWriter& writer,
                       const Instruction& instruction);

}  // namespace a2rt::spirv
