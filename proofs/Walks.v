(* Pedestrians (D19): the ego passes a crossing before they can come to it, from whichever side, or rests before it. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement Ego Plan Shield.
Open Scope R_scope.

(* It may turn back at any time: its place changes at its pace at most. *)
Definition walks (pace : R) (t : R -> R) (from : R) :=
  forall x y, from <= x -> x <= y -> Rabs (t y - t x) <= pace * (y - x).

(* Where it may be, by what is seen and by how far it may have walked since. *)
Inductive walker_known (k : contract) (pace : R) (t : R -> R) (from : R) : R -> R -> R -> Prop :=
  | seen_there u place : from <= u -> place - position_error k <= t u <= place + position_error k ->
      walker_known k pace t from u (place - position_error k) (place + position_error k)
  | has_walked u u' lo hi : walker_known k pace t from u lo hi -> u <= u' ->
      walker_known k pace t from u' (lo - pace * (u' - u)) (hi + pace * (u' - u)).

Section Crossing.
Variables (k : contract) (l : log) (c : nat -> R) (z : zone) (since : nat) (pace : R) (lo hi : nat -> R).

(* D8, D19: it is so far from its zone, on one side, that it cannot come to it until the ego has passed its own. *)
Definition passes_walker (i : nat) :=
  let target := s_out z - own_s (ego_at l i) + 3 * position_error k in
  let clears := fst (clearing k (least (departs_at k l c i)) target) in
  in_time k (departs_at k l c i) (goes l i) target /\
  0 <= Rmax (t_in z - hi i) (lo i - t_out z) - pace * clears - slack k.

Definition walker_judged (i : nat) :=
  s_out z <= own_least (ego_at l i) \/
  in_force k l c since (fun i0 => stops k (departs_at k l c i0) (goes l i0) (stop_limit k z (ego_at l i0)) \/ passes_walker i0) i.
End Crossing.

Definition Pedestrians := forall k z s v t pace tau c l since lo hi,
  valid k -> motion s v -> on_grid k tau -> obeys k v tau c -> true_log k l s v tau c ->
  0 <= pace -> walks pace t (tau since) -> (1 <= since)%nat ->
  (forall i, (since <= i)%nat -> walker_known k pace t (tau since) (tau i) (lo i) (hi i)) ->
  (forall i, (since <= i)%nat -> walker_judged k l c z since pace lo hi i) ->
  forall u, tau since <= u -> ~ inside z (s u) (t u).

Lemma walker_there k pace t from u lo hi : walks pace t from -> walker_known k pace t from u lo hi -> from <= u /\ lo <= t u <= hi.
Proof.
  intros W. induction 1 as [u place le at_ | u u' lo hi kn [le at_] later_]; [auto |]. split; [lra |].
  pose proof (W u u' le later_) as D. revert D. unfold Rabs. destruct (Rcase_abs _); lra.
Qed.

Theorem pedestrians_are_kept_clear_of : Pedestrians.
Proof.
  intros k z s v t pace tau c l since lo hi ok ms grid obey log_ p0 W start_ there judges u from ins.
  destruct (between_calls k tau ok grid since u from) as (i & h & hu).
  destruct ins as ((s1 & s2) & (t1 & t2) & _).
  pose proof (calls_ordered k tau ok grid) as ordered.
  destruct (judges i h) as [past | (i0 & hi0 & ver & carried)].
  { destruct (truth k s v tau c l log_ since start_ i ltac:(lia)) as ((_ & _ & least_) & _).
    pose proof (advances s v (tau i) u ms ltac:(lra)). lra. }
  pose proof (ordered i0 i ltac:(lia)). pose proof (ordered since i0 ltac:(lia)).
  destruct ver as [st | [it clear]].
  { pose proof (rests_before k s v tau c l ok ms grid obey log_ z since start_ i0 i hi0 carried u st ltac:(lra)). lra. }
  destruct (where_ k s v tau c l log_ since start_ i0 i hi0) as (sT & vT & _).
  destruct (command_range k s v tau c l obey log_ since start_ i0 i hi0) as [ca cp].
  assert (eps : 0 <= position_error k) by (destruct ok; lra). assert (sl : 0 < slack k) by (destruct ok; lra).
  set (target := s_out z - own_s (ego_at l i0) + 3 * position_error k) in *.
  destruct (plan_clears k s v (tau i0) (tau (S i)) _ _ _ (own_v (ego_at l i0)) (goes l i0) ok ms
              (followed k s v tau c l ok ms grid obey log_ since start_ i0 i hi0 carried) target
              ltac:(destruct vT; lra) cp (proj2 ca) it) as (_ & _ & gone & _).
  change (departure k (own_v (ego_at l i0)) (previous_least l i0) (previous_most l i0) (c i0)) with (departs_at k l c i0) in gone.
  set (clears := fst (clearing k (least (departs_at k l c i0)) target)) in *.
  destruct (Rle_dec u (tau i0 + clears)) as [early | late].
  - destruct (walker_there _ _ _ _ _ _ _ W (there i0 ltac:(lia))) as [_ B].
    pose proof (W (tau i0) u ltac:(lra) ltac:(lra)) as D.
    assert (pace * (u - tau i0) <= pace * clears) by (apply Rmult_le_compat_l; lra).
    revert clear D. unfold Rabs. destruct (Rcase_abs _); cases; lra.
  - specialize (gone ltac:(lra)). pose proof (advances s v (tau i0 + clears) u ms ltac:(lra)). unfold target in gone. lra.
Qed.
