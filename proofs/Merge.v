(* Theorem 2, merging at once. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart Entry Shield.
Open Scope R_scope.

(* Who comes in ahead leads by more than the band. *)
Lemma comes_in_with_lead k z s v t w x :
  valid k -> motion s v -> motion t w -> comes_in_ahead k z s v t w x ->
  s x = s_in z /\ slack k <= s x - t x - lead_to z.
Proof.
  intros ok ms mt (tau & c & l & b & i0 & i & grid & obey & true & keeps & seen & order & carried & [la en] & before & h & at_ & first).
  split; [exact at_ |].
  destruct (enters_ahead_safely k s v tau c l ok ms grid obey true t w b z i0 mt keeps seen (proj1 order) i0 i
              ltac:(lia) carried x en h ltac:(lra)) as (x' & [x1 x2] & _ & exactly & gap).
  specialize (exactly before).
  assert (x' = x) as ->.
  { destruct (Rle_lt_or_eq_dec x' x x2) as [lt | eq]; [specialize (first x' lt); lra | exact eq]. }
  assert (0 <= safe_gap k (w x) (v x)) by (rewrite safe_gap_is; apply Rmax_r). lra.
Qed.

Theorem at_most_one_comes_in_ahead : Theorem2.
Proof.
  intros k z y s v t w x1 x2 ok (e1 & _ & _ & _ & e2 & e3) corner ms mt one two.
  destruct (comes_in_with_lead k z s v t w x1 ok ms mt one) as [at1 lead1].
  destruct (comes_in_with_lead k y t w s v x2 ok mt ms two) as [at2 lead2].
  rewrite e1 in at2. unfold corner_in_band in corner.
  assert (0 < slack k) by (destruct ok; lra).
  destruct (Rle_dec x1 x2) as [le | gt].
  - pose proof (advances s v x1 x2 ms le). lra.
  - pose proof (advances t w x2 x1 mt ltac:(lra)). lra.
Qed.
