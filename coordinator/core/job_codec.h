// Bytes of a job's description, for facts (fact.h). Every part that may get new members is a versioned record
// (byte_codec.h).
//   digest      text of 32 bytes
//   JobOrder    record: version 1: submission, name, priority, package, scene file, options, whether it is a
//               sequence, first, last and step of its frames, frames per second
//   JobSpec     record: version 1: submission, name, priority, package, frames, tags, verify share
//               version 2, which readers of version 1 may ignore: whether there is a region that is rendered
//               first, its x0, x1, y0, y1
//   FrameRequest  record: version 1: scene file, options, number, extendable, FrameSpec
//   FrameSpec   record: version 1: size, crop, samples, tile size, EXR type, channels (name, type, rule,
//               written), attributes, noise threshold; version 2: denoiser; version 3: levels of Cryptomatte
// A new member is appended to its record and gets a default where an older record is read.
#pragma once

#include <vector>

#include "coordinator/core/byte_codec.h"
#include "proto/terms.h"

namespace tessera {

void AddDigest(ByteWriter& out, const Digest& digest);
bool ReadDigest(ByteReader& in, Digest& digest);

void AddChannels(ByteWriter& out, const std::vector<Channel>& channels);
// False for types and rules that are unknown; whether the list makes sense is FrameSpec's affair.
bool ReadChannels(ByteReader& in, std::vector<Channel>& channels);

void AddJobSpec(ByteWriter& out, const JobSpec& spec);
// False for anything that AddJobSpec does not write, and for what is beyond the limits.
bool ReadJobSpec(ByteReader& in, JobSpec& spec);
void AddJobOrder(ByteWriter& out, const JobOrder& order);
// False for anything that AddJobOrder does not write, and for what is beyond the limits.
bool ReadJobOrder(ByteReader& in, JobOrder& order);
// Reads what releases wrote whose channels were a list of names: no records, and the samples channel a flag
// of its own.
bool ReadJobSpecByNames(ByteReader& in, JobSpec& spec);

}  // namespace tessera
