(* Control of Theorem 4: two vehicles that both claim at once, and go, are in a crossing together, though all else holds. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Ego Controls Passage.
Open Scope R_scope.

(* Both drive as in Passage.v, from rest, 2 m before the crossing. *)
Definition meeting : zone := {|
  s_in := 2; s_out := 4; t_in := 2; t_out := 4; lead_from := -1000; lead_to := 1000; lane := false |}.
Definition the_bounds (i : nat) := sensed k (s (INR i)) (v (INR i)).

Lemma both_keep : keeps_contract k v 1.
Proof.
  split; intros u x y ? ? ?; unfold k, round; cbn [other_acceleration other_max_speed other_braking]; unfold v; cases; lra.
Qed.

Lemma both_watch : watches k (judged k the_log c the_bounds meeting (fun i => i = 1%nat) 1) s v s v INR c the_log the_bounds 1.
Proof.
  assert (s1 : s 1 = 0) by apply (RInt_point 1 v).
  assert (v1 : v 1 = 0) by (rewrite v_goes; lra).
  constructor.
  - exists 0. intros i. cbn. lra.
  - exact ego_obeys.
  - intros i. pose proof (commanded _ _ _ _ ego_obeys i) as [_ C]. revert C. unfold own_holds. cbn -[INR c Nat.sub].
    replace (S i - 1)%nat with i by lia. lra.
  - exact both_keep.
  - intros i hi. apply seen; cbn -[INR]; try lra. change 1 with (INR 1). apply le_INR. exact hi.
  - lia.
  - intros i hi. do 3 right. exists 1%nat. split; [lia |]. split; [| intros q hq; apply carried; lia].
    split; [reflexivity |]. unfold the_bounds, rest_of, sensed, start, k, round. cbn. rewrite s1, v1. cases; lra.
Qed.

Theorem newer_is_needed :
  valid k /\ precedence_braking k <= ego_braking k /\ lane meeting = false /\ mirrored meeting meeting /\ motion s v /\
  watches k (judged k the_log c the_bounds meeting (fun i => i = 1%nat) 1) s v s v INR c the_log the_bounds 1 /\ inside meeting (s (7 / 2)) (s (7 / 2)).
Proof.
  assert (s1 : s 1 = 0) by apply (RInt_point 1 v).
  pose proof (above_line s v 0 1 1 (7 / 2) ego_moves ltac:(lra)) as A.
  pose proof (below_line s v 0 1 1 (7 / 2) ego_moves ltac:(lra)) as B.
  assert (line : forall u, 1 <= u <= 7 / 2 -> v u = 0 + 1 * (u - 1)) by (intros; rewrite v_goes; lra).
  specialize (A ltac:(intros u h; rewrite (line u h); lra)). specialize (B ltac:(intros u h; rewrite (line u h); lra)).
  split; [apply round_valid; lra |]. split; [cbn; lra |]. split; [reflexivity |].
  split; [unfold mirrored; cbn; lra |]. split; [exact ego_moves |]. split; [exact both_watch |].
  unfold inside. cbn. lra.
Qed.
