#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
// Tests whether invocations 32 k to 32 k + 31 of a work group are its subgroup k, with lanes in order, and exchange
// data only with each other. All shaders with subgroups rely on this order. The test runs in all work group sizes of
// these shaders (gl/subgroups.cpp). A driver may run subgroups of another size than it reports.
#define INVOCATIONS (COLUMNS * ROWS)
#define PATTERN 0x5EA1C0DEu
layout(local_size_x = COLUMNS, local_size_y = ROWS) in;

layout(std430, binding = 0) buffer Wrong { uint wrong; };  // a bit for each fault

void main() {
  uint self = gl_LocalInvocationIndex, lane = self % 32u, subgroup = self / 32u;
  // The last lane of every other subgroup votes: only its own subgroup may see the vote.
  bool speaks = lane == 31u && subgroup % 2u == 0u;
  uint from = (lane * 13u + 7u) % 32u;
  uvec4 all = subgroupBallot(true), some = subgroupBallot((PATTERN >> lane & 1u) != 0u);
  bool heard = subgroupAny(speaks);
  uint shuffled = subgroupShuffle(self, from), sum = subgroupAdd(self), ones = subgroupInclusiveAdd(1u);
  uint faults = 0u;
  if (gl_SubgroupSize != 32u || gl_NumSubgroups != INVOCATIONS / 32u) faults |= SUBGROUPS_OF_OTHER_SIZE;
  if (gl_SubgroupID != subgroup || gl_SubgroupInvocationID != lane || gl_SubgroupLtMask.x != (1u << lane) - 1u)
    faults |= SUBGROUPS_IN_OTHER_ORDER;
  if (all != uvec4(0xFFFFFFFFu, 0u, 0u, 0u) || some != uvec4(PATTERN, 0u, 0u, 0u) || heard != (subgroup % 2u == 0u))
    faults |= SUBGROUPS_VOTE_WITH_OTHERS;
  if (shuffled != subgroup * 32u + from) faults |= SUBGROUPS_SHUFFLE_OTHERS;
  if (sum != 1024u * subgroup + 496u || ones != lane + 1u) faults |= SUBGROUPS_ADD_OTHERS;
  if (faults != 0u) atomicOr(wrong, faults);
}
