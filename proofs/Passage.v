(* Controls: an ego that goes through a crossing. All conditions of Theorem 1 hold, its plan is verified by its passage, and it
   is carried out: the ego accelerates at 1 m/s² for three seconds, is across, and brakes to rest. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Ego Controls.
Import ListNotations.
Open Scope R_scope.

Definition k : contract := round 2 4 1 (1 / 100).

(* The other stands 100 m before the crossing. *)
Definition crossing : zone := {|
  s_in := 2; s_out := 4; t_in := 100; t_out := 104; lead_from := -1000; lead_to := 1000; lane := false |}.

Definition v (u : R) := Rmax 0 (Rmin (u - 1) (11 - 2 * u)).
Definition s (u : R) := RInt v 1 u.
Arguments v : simpl never.
Arguments s : simpl never.

(* Call i is at second i; calls 1 to 3 command go, the later ones brakes. *)
Definition c (i : nat) : R := if andb (Nat.leb 1 i) (Nat.leb i 3) then 1 else -2.
Definition the_log : log := {|
  ego_at i := {| own_s := s (INR i); own_v := v (INR i); own_least := s (INR i) |};
  previous_least i := c (i - 1); previous_most i := c (i - 1); goes i := (3 - i)%nat |}.
Definition the_view (_ : unit) (_ : nat) := sensed k 0 0.
Definition the_other : other unit := {|
  place _ := 0; rate _ := 0; on := tt; since := 1%nat; candidates _ _ := True; view := the_view; claims _ _ _ := False |}.

Lemma Rmin_via_max x y : Rmin x y = x - Rmax 0 (x - y).
Proof. cases; lra. Qed.

Lemma ego_moves : motion s v.
Proof.
  apply moves_by; [| intros; apply Rmax_l]. intros x.
  apply (continuous_positive (fun u => Rmin (u - 1) (11 - 2 * u))).
  apply (continuous_ext (fun u => (u - 1) - Rmax 0 ((u - 1) - (11 - 2 * u)))).
  { intros u. symmetry. apply Rmin_via_max. }
  apply (continuous_minus (fun u => u - 1) (fun u => Rmax 0 ((u - 1) - (11 - 2 * u)))).
  - apply (continuous_minus (fun u => u) (fun _ => 1)); [apply continuous_id | apply continuous_const].
  - apply continuous_positive. apply (ex_derive_continuous (fun u => (u - 1) - (11 - 2 * u))). auto_derive. trivial.
Qed.

Lemma v_goes u : 1 <= u <= 4 -> v u = u - 1.
Proof. intros. unfold v. cases; lra. Qed.

Lemma v_brakes u : 4 <= u -> v u = Rmax 0 (11 - 2 * u).
Proof. intros. unfold v. cases; lra. Qed.

Lemma c_goes i : (1 <= i <= 3)%nat -> c i = 1.
Proof. intros. unfold c. replace (Nat.leb 1 i) with true by (symmetry; apply Nat.leb_le; lia).
  replace (Nat.leb i 3) with true by (symmetry; apply Nat.leb_le; lia). reflexivity. Qed.

Lemma c_brakes i : (4 <= i)%nat -> c i = -2.
Proof. intros. unfold c. replace (Nat.leb i 3) with false by (symmetry; apply Nat.leb_gt; lia).
  rewrite Bool.andb_false_r. reflexivity. Qed.

Lemma ego_obeys : obeys k v INR c.
Proof.
  pose proof (forwards s v ego_moves) as pos.
  assert (up : forall a t, speeds_up_at_most v a t (t + 0)).
  { intros a t. apply (at_most_point v pos). lra. }
  assert (down : forall a cap t, speeds_up_at_least v a cap t (t + 0)).
  { intros a cap t. apply at_least_point. lra. }
  assert (going : forall i, (S i <= 3)%nat -> 1 <= INR (S i) /\ INR (S (S i)) <= 4).
  { intros i h. split; [change 1 with (INR 1); apply le_INR; lia |].
    replace 4 with (INR 4) by (simpl; lra). apply le_INR. lia. }
  assert (braking : forall i, (4 <= S i)%nat -> 4 <= INR (S i)).
  { intros i h. replace 4 with (INR 4) by (simpl; lra). apply le_INR. lia. }
  constructor; intros i.
  - cbn. destruct (le_lt_dec i 3); [destruct i |]; [unfold c; cbn; lra | rewrite c_goes by lia; lra | rewrite c_brakes by lia; lra].
  - apply up.
  - cbn [latency k round]. destruct (le_lt_dec (S i) 3) as [g | b].
    + destruct (going i g). rewrite c_goes by lia. intros x y ? ? ?. rewrite !v_goes by lra. cases; lra.
    + pose proof (braking i b). rewrite c_brakes by lia. intros x y ? ? ?. rewrite !v_brakes by lra. cases; lra.
  - apply down.
  - cbn [latency k round]. destruct (le_lt_dec (S i) 3) as [g | b].
    + destruct (going i g). rewrite c_goes by lia. intros x y ? ? ?. rewrite !v_goes by lra.
      apply Rle_trans with (1 := Rmin_l _ _). lra.
    + pose proof (braking i b). rewrite c_brakes by lia. intros x y ? ? ?. rewrite !v_brakes by lra.
      apply Rle_trans with (1 := Rmin_l _ _). cases; lra.
Qed.

Lemma carried i : (1 <= i)%nat -> carries_on k the_log c i.
Proof.
  intros h. unfold carries_on. cbn [goes the_log]. destruct (3 - i)%nat as [| n] eqn:e.
  - split; [rewrite c_brakes by lia; reflexivity | lia].
  - split; [unfold goes_on; rewrite c_goes by lia; split; [apply Rmin_l | apply Rle_refl] | lia].
Qed.

(* The plan goes for two more periods: by then the ego is certainly across, and the other has not arrived. *)
Lemma passage_verified : verified_at k the_log c (the_view tt) crossing 1.
Proof.
  right. cbn [lane crossing].
  assert (s1 : s 1 = 0) by apply (RInt_point 1 v).
  assert (v1 : v 1 = 0) by (rewrite v_goes; lra).
  assert (cap : unlimited k = 9).
  { unfold unlimited, k, round, switching. cbn. lra. }
  assert (L : least (departs_at k the_log c 1) = {| distance := 1 / 2; speed := 1 |}).
  { unfold departs_at. rewrite departure_is. cbn zeta. cbn [least]. rewrite cap.
    unfold the_log, at_least, start, shortest_period, switching, k, round, c. cbn. rewrite v1. evaluate. f_equal; lra. }
  assert (target_ : s_out crossing - own_s (ego_at the_log 1) + 3 * position_error k = 4).
  { cbn. rewrite s1. lra. }
  assert (sq : 0 <= sqrt 8 <= 3).
  { split; [apply sqrt_pos |]. rewrite <- (sqrt_square 3) by lra. apply sqrt_le_1_alt. lra. }
  assert (V : sqrt (1 * 1 + (1 + 1) * (7 / 2)) = sqrt 8) by (f_equal; lra).
  assert (one : 1 <= sqrt 8) by (rewrite <- sqrt_1 at 1; apply sqrt_le_1_alt; lra).
  assert (clears : fst (clearing k (least (departs_at k the_log c 1)) 4) = sqrt 8).
  { rewrite clearing_is, L, cap. unfold until, shortest_period, switching, k, round. cbn [fst distance speed ego_go period jitter latency].
    rewrite (Rmax_left (4 - 1 / 2) 0) by lra. rewrite (Rmax_left 9 1) by lra.
    rewrite (Rmin_left (4 - 1 / 2)) by lra.
    rewrite (Rmax_right (4 - 1 / 2 - _) 0) by lra.
    replace (1 * 1 + (1 + 1) * (4 - 1 / 2)) with 8 by lra.
    rewrite (Rmax_left (sqrt 8 - 1) 0) by lra. field. }
  unfold Statement.passes, in_time. rewrite target_, clears. cbn [goes the_log].
  split.
  - unfold shortest_period, k, round. simpl. lra.
  - unfold clears_before. rewrite rush_is.
    destruct (rushing_early (start (w_most (the_view tt 1))) 1 10 (sqrt 8) ltac:(lra) ltac:(lra)) as [D _].
    { cbn. cases; lra. }
    cbn [other_acceleration other_max_speed k round]. rewrite D. cbn.
    assert (Rmax (Rmax (0 + 0) 0) 0 = 0) as -> by (cases; lra).
    assert (sqrt 8 * sqrt 8 <= 9) by (apply Rle_trans with (3 * 3); [apply Rmult_le_compat |]; lra). lra.
Qed.

Theorem a_passage_can_be_verified :
  Conditions valid keeps_all k unit (fun _ => [crossing]) (fun _ => inside crossing) s v INR c the_log (fun o => o = the_other) /\
  s_out crossing < s 4.
Proof.
  split.
  - split; [apply round_valid; lra |].
    split; [intros _ x y ins; exists crossing; split; [left; reflexivity | exact ins] |].
    split; [exact ego_moves |].
    split; [exists 0; intros i; cbn; lra |].
    split; [exact ego_obeys |].
    split.
    { intros i. pose proof (commanded _ _ _ _ ego_obeys i) as [_ C]. revert C. unfold own_holds. cbn -[INR c Nat.sub].
      replace (S i - 1)%nat with i by lia. lra. }
    split.
    + intros o ->. constructor.
      * apply (rest_moves 0).
      * split; intros u x y ? ? ?; cbn; cases; lra.
      * intros i hi. apply seen; cbn -[INR]; try lra. change 1 with (INR 1). apply le_INR. exact hi.
      * intros z [<- | []]. discriminate.
      * intros z [<- | []] i0 i _ [].
      * intros z [<- | []]. discriminate.
      * cbn. trivial.
      * cbn. lia.
    + intros o i p z -> hi _ [<- | []]. destruct p. right; right; left. exists 1%nat. split; [cbn in *; lia |].
      split; [exact passage_verified |]. intros j hj. apply carried. lia.
  - pose proof (above_line s v 0 1 1 4 ego_moves ltac:(lra)) as A.
    assert (s1 : s 1 = 0) by apply (RInt_point 1 v).
    cbn. apply Rlt_le_trans with (0 * (4 - 1) + 1 * (4 - 1) * (4 - 1) / 2); [lra |].
    apply Rle_trans with (s 4 - s 1); [| lra]. apply A. intros u ?. rewrite v_goes by lra. lra.
Qed.
