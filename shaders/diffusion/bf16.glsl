// The nearest bf16 number, as the bits of a float whose lower half is zero.
uvec4 rounded_bits(vec4 v) { return (floatBitsToUint(v) + 0x8000u) & 0xffff0000u; }
